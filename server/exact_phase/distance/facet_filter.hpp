#pragma once

#include <cstdint>

#include "server/exact_phase/distance/core.hpp"

namespace collided::engine::kernel {

/// Which facet axes may be the one along which two cores need the least push to part: a bit each. In plain double with
/// one error bound an axis, so that the arithmetic with running bounds is spent on the few that are left, mostly one.
///
/// promise  an axis that is left out has, in Bounded, a depth whose low() is above the high() of another axis
/// cost     about 70 operations an axis, a twentieth of push_out<Bounded>
std::uint32_t axes_of_least_push(const FacetAxes& axes, const Core& a, const Core& b);

}  // namespace collided::engine::kernel
