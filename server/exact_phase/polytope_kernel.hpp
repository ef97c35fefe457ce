#pragma once

#include "server/exact_phase/convex.hpp"

namespace collided::kernel {

/// Whether two polytopes, each with its ball about every point, share a point: rationals alone.
///
/// returns  undecided only where a coordinate is not finite
/// cost     0.1 to 10 ms; allocates
/// source   Gilbert, Johnson, Keerthi 1988 as in simplex_search.hpp; in exact arithmetic every step comes nearer, so
///          the search over finitely many simplices ends
Decision polytopes_meet(const Convex& a, const Convex& b);

}  // namespace collided::kernel
