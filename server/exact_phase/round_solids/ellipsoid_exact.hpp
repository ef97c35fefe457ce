#pragma once

#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/kernels/straight_motion.hpp"

namespace collided::engine::kernel {

/// Whether an ellipsoid and a point, segment, triangle, box or hull share a point: seen in the ellipsoid's own coordinates
/// it is a ball. By rationals alone.
///
/// motion   at any time of the ellipsoid's motion against the other; null: as they stand
/// returns  undecided only where a number is not finite or the ellipsoid is flat
Decision ellipsoid_meets_flat(const Convex& ellipsoid, const Convex& flat, const StraightMotion* motion = nullptr);

/// Two ellipsoids, one of them a ball at will, neither without extent. By rationals alone.
///
/// source  Wang, Wang, Kim, "An algebraic condition for the separation of two ellipsoids", 2001: they are apart where
///         det(x A + B) has two different positive roots
Decision ellipsoids_meet(const Convex& a, const Convex& b);

/// An ellipsoid and the disc about one end of a cylinder's axis.
Decision ellipsoid_meets_disc(const Convex& ellipsoid, const Convex& cylinder, int end);

/// An ellipsoid and all that is within the radius of the line through a cylinder's or capsule's axis.
Decision ellipsoid_meets_endless(const Convex& ellipsoid, const Convex& cylinder);

}  // namespace collided::engine::kernel
