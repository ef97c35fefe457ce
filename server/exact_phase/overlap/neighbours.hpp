#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

// Whether triangles of one surface meet where they should not. Both have area; exact for the given doubles.

/// Two triangles with a.a = b.a: they have a point in common besides it.
/// cost      20 ns where one lies on one side of the other, 70 where they part in a projection
/// threads   pure; allocates only on Level::rational
ExactResult meet_beyond_corner(const Triangle& a, const Triangle& b);

/// Two triangles with a.a = b.a and a.b = b.b: they have a point in common besides that edge; they lie in one plane,
/// folded over each other.
ExactResult meet_beyond_edge(const Triangle& a, const Triangle& b);

}  // namespace collided::engine
