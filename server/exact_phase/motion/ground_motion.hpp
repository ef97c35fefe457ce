#pragma once

#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/motion/part_motion.hpp"

namespace collided::engine {

/// first_contact of a moving part with a half-space at rest: halves the motion until every piece either keeps clear
/// (its middle is farther from the plane than its ends can be from the middle) or is short enough to be the bracket.
///
/// given  the half-space before it was placed
ExactResult first_contact(const PartMotion& part, const HalfSpace& ground, TimeSpan span, double width,
                          TimeBracket& bracket, const GivenPart& given = {});

/// True if no point within reach_m of the frame's origin reaches the half-space during the motion; false proves
/// nothing.
bool surely_stays_above(const BodyMotion& motion, double reach_m, const HalfSpace& ground);

}  // namespace collided::engine
