#pragma once

#include "server/exact_phase/round_solids/exact_solid.hpp"

namespace collided::engine::kernel {

/// Whether two convex sets share a point, if no algebra decides: the search of simplex_search.hpp in 256 bits proposes
/// a plane between them or a point of both, which rationals then test.
///
/// returns  undecided if the sets neither overlap nor leave a gap by more than kFinestGap of their size, or if some
///          hundred steps did not suffice
/// cost     1 to 100 ms; allocates
Decision refined_meet(const ExactSolid& a, const ExactSolid& b);

}  // namespace collided::engine::kernel
