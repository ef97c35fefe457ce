#pragma once

#include <optional>

#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/kernels/straight_motion.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"

namespace collided::engine::kernel {

/// Whether two convex sets share a point at any time of a straight motion: the volume swept by a convex set is convex,
/// with corners and faces of the same kinds.
///
/// a, b     placed at the beginning of the motion
/// returns  undecided for two sets with round parts other than balls, and for a ball or capsule against such a set
/// cost     0.1 to 10 ms; allocates
ExactResult meet_on_motion(const Convex& a, const Convex& b, const StraightMotion& motion);

/// Decides up to motion.until, with a bracket of the first contact, no wider than `width`. `guess` is an approximate
/// time and affects no decision. The bracket is unchanged unless the answer is yes.
ExactResult first_contact_on_motion(const Convex& a, const Convex& b, const StraightMotion& motion, double guess,
                                    double width, TimeBracket& bracket);

/// Whether the set reaches the half-space during its motion.
ExactResult first_contact_on_motion(const Convex& a, const HalfSpace& ground, const StraightMotion& motion,
                                    double guess, double width, TimeBracket& bracket);

}  // namespace collided::engine::kernel
