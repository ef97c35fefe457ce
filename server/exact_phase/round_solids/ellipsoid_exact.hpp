#pragma once

#include "server/exact_phase/kernels/straight_motion.hpp"
#include "server/exact_phase/round_solids/exact_solid.hpp"

namespace collided::engine::kernel {

/// Whether an ellipsoid and a point, segment, triangle, box or hull share a point: in the ellipsoid's own coordinates
/// it is a ball. By rationals alone.
///
/// motion   test any time of the ellipsoid's motion relative to the other; null: both at rest
/// returns  undecided only if a number is not finite or the ellipsoid is flat
Decision ellipsoid_meets_flat(const Convex& ellipsoid, const Convex& flat, const StraightMotion* motion = nullptr);

/// Whether an ellipsoid and the hull of some points share a point.
Decision ellipsoid_meets_hull(const ExactSolid& ellipsoid, const std::vector<Vector<Dyadic>>& corners);

/// Two ellipsoids; either may be a ball; both must have extent. By rationals alone.
///
/// source  Wang, Wang, Kim, "An algebraic condition for the separation of two ellipsoids", 2001: they are separate if
///         det(x A + B) has two different positive roots
Decision ellipsoids_meet(const ExactSolid& a, const ExactSolid& b);

/// Whether an ellipsoid meets the disc at one end of a cylinder's axis.
Decision ellipsoid_meets_disc(const ExactSolid& ellipsoid, const ExactSolid& cylinder, int end);

/// Whether an ellipsoid meets the infinite cylinder around the axis of a cylinder or capsule.
Decision ellipsoid_meets_endless(const ExactSolid& ellipsoid, const ExactSolid& cylinder);

}  // namespace collided::engine::kernel
