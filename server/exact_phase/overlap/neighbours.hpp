#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

// Whether triangles of one surface meet where they should not. Both must have area; exact for the given doubles.

/// Whether two triangles with a.a = b.a have another point in common.
/// cost      20 ns if one lies on one side of the other, 70 if a projection separates them
/// threads   pure; allocates only on Level::rational
ExactResult meet_beyond_corner(const Triangle& a, const Triangle& b);

/// Whether two triangles with a.a = b.a and a.b = b.b have points in common beyond that edge: then they lie in one
/// plane, folded over each other.
ExactResult meet_beyond_edge(const Triangle& a, const Triangle& b);

}  // namespace collided::engine
