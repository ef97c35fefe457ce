#pragma once

#include "server/exact_phase/kernels/straight_motion.hpp"
#include "server/exact_phase/round_solids/exact_solid.hpp"

namespace collided::engine::kernel {

/// Whether a cylinder or cone and a point, segment, triangle, box or hull share a point, tested by the features of the
/// latter.
///
/// motion   test any time of the solid's motion relative to the other; null: both at rest
/// returns  undecided only if a number is not finite, or a hull bent by rounding has too many corners
/// cost     a microsecond per feature, more where it is uncertain; allocates
ExactResult axial_meets_flat(const Convex& axial, const Convex& flat, const StraightMotion* motion = nullptr);

// The following use rationals alone.

/// axial_meets_flat() for sets at rest; the flat one has its border.
Decision axial_meets_border(const ExactSolid& axial, const ExactSolid& flat);

/// Whether a cylinder or cone and a ball share a point.
Decision axial_meets_ball(const ExactSolid& axial, const Vector<Dyadic>& center, const Dyadic& radius);

/// Tests cylinders and capsules by their round sides, given that no end of a capsule reaches the other set: finds a
/// point between the feet of the two axes, or a plane perpendicular to the line between them. Undecided if neither
/// exists.
Decision sides_meet(const ExactSolid& a, const ExactSolid& b);

/// Two cylinders or cones with exactly parallel axes; undecided for others.
Decision parallel_axials_meet(const ExactSolid& a, const ExactSolid& b);

}  // namespace collided::engine::kernel
