#pragma once

#include "server/exact_phase/distance/convex.hpp"

namespace collided::engine::kernel {

// The flat ends of cylinders, which are discs, by rationals alone. Undecided only where a number is not finite.

/// The discs about one end each of two cylinders' axes.
Decision discs_meet(const Convex& a, int end_a, const Convex& b, int end_b);

/// A disc and all that is within the radius of the line through the axis of a cylinder or capsule.
Decision disc_meets_endless(const Convex& cylinder, int end, const Convex& side);

}  // namespace collided::engine::kernel
