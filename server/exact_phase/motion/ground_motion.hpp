#pragma once

#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/motion/part_motion.hpp"

namespace collided::engine {

/// As first_contact of two parts on their ways, for a half-space that rests: the way is halved until no piece is left
/// whose middle is farther from the plane than its ends can be from it.
ExactResult first_contact(const PartMotion& part, const HalfSpace& ground, TimeSpan span, double width, TimeBracket& bracket);

/// Whether no point within reach_m of the frame's origin comes to the half-space on the way; false says nothing.
bool surely_stays_above(const BodyMotion& motion, double reach_m, const HalfSpace& ground);

}  // namespace collided::engine
