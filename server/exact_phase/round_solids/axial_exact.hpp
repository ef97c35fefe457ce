#pragma once

#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/kernels/straight_motion.hpp"

namespace collided::engine::kernel {

/// Whether a cylinder or cone and a point, segment, triangle, box or hull share a point, by the features of the latter.
///
/// motion   at any time of the solid's motion against the other; null: as they stand
/// returns  undecided only where a number is not finite, or the hull has too many corners that rounding has bent
/// cost     a microsecond a feature, more where it is in doubt; allocates
ExactResult axial_meets_flat(const Convex& axial, const Convex& flat, const StraightMotion* motion = nullptr);

// By rationals alone:

/// A cylinder or cone and a ball.
Decision axial_meets_ball(const Convex& axial, const Vec3& center, double radius_m);

/// Cylinders and capsules by their round sides, given that no end of a capsule reaches the other set: a point that lies
/// between the two axes' feet, or a plane across the way between them. Undecided where neither is.
Decision sides_meet(const Convex& a, const Convex& b);

/// Two cylinders or cones whose axes are parallel to the last digit; undecided where they are not.
Decision parallel_axials_meet(const Convex& a, const Convex& b);

}  // namespace collided::engine::kernel
