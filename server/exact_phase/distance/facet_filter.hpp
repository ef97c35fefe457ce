#pragma once

#include <cstdint>

#include "server/exact_phase/distance/core.hpp"

namespace collided::engine::kernel {

/// Bound on a depth's error along a normal n = u x v of edges u and v, in units of S |u| |v| / |n|, with largest
/// coordinates in place of lengths, and S what two points of the cores may differ by on any axis. No unit.
/// The difference of two products and both differences before leave at most 8 roundings of |u| |v| in a component of n;
/// three products with differences of points and six extents along it 64 more of S |u| |v|; the root and the quotient
/// some 32 of the depth, which is at most 2 S; the products over cross axes of two boxes, which reuse those over faces,
/// 96 (kSeparationError). In Bounded the same operations are made, with a bound of at most twice
/// what they may err. 2^9 roundings cover both; 2^12 are taken.
/// At zero, ExactContact.AFilterKeepsEveryAxisOfATie fails.
inline constexpr double kDepthError = 0x1p-41;

/// Which facet axes may be the one along which two cores need the least push to part: a bit each. In plain double with
/// one error bound an axis, so that the arithmetic with running bounds is spent on the few that are left, mostly one.
///
/// promise  an axis that is left out has, in Bounded, a depth whose low() is above the high() of another axis
/// cost     about 70 operations an axis, a twentieth of push_out<Bounded>
std::uint32_t axes_of_least_push(const FacetAxes& axes, const Core& a, const Core& b);

}  // namespace collided::engine::kernel
