#pragma once

#include <cstdint>

#include "server/exact_phase/distance/core.hpp"

namespace collided::engine::kernel {

/// Bound on a depth's error along a normal n = u x v of edges u and v, in units of S |u| |v| / |n|, with largest
/// coordinates in place of lengths, and S the largest coordinate difference of two points of the cores. No unit. The
/// difference of two products and both differences before leave at most 8 roundings of |u| |v| in a component of n;
/// three products with differences of points and six extents along it 64 more of S |u| |v|; the root and the quotient
/// some 32 of the depth, which is at most 2 S; the products over cross axes of two boxes, which reuse those over faces,
/// 96 (kSeparationError). In Bounded the same operations have bounds of at most twice their error. 2^9 roundings cover
/// both; 2^12 are taken.
/// At zero, ExactContact.AFilterKeepsEveryAxisOfATie fails.
inline constexpr double kDepthError = 0x1p-41;

/// Which facet axes may need the least push to separate two cores: a bit each. In plain double with one error bound per
/// axis, so that arithmetic with running bounds is spent on the few remaining ones, mostly one.
///
/// promise  an axis that is left out has, in Bounded, a depth whose low() is above the high() of another axis
/// cost     about 70 operations per axis, a twentieth of push_out<Bounded>
std::uint32_t axes_of_least_push(const FacetAxes& axes, const Core& a, const Core& b);

}  // namespace collided::engine::kernel
