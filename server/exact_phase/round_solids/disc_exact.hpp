#pragma once

#include "server/exact_phase/round_solids/exact_solid.hpp"

namespace collided::engine::kernel {

// The flat ends of cylinders, which are discs, by rationals alone. Undecided only if a number is not finite.

/// Whether the discs at one end each of two cylinders' axes share a point.
Decision discs_meet(const ExactSolid& a, int end_a, const ExactSolid& b, int end_b);

/// Whether a disc meets the infinite cylinder around the axis of a cylinder or capsule.
Decision disc_meets_endless(const ExactSolid& cylinder, int end, const ExactSolid& side);

}  // namespace collided::engine::kernel
