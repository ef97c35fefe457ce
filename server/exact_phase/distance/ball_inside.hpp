#pragma once

#include "server/exact_phase/distance/simplex_search.hpp"

namespace collided::engine::kernel {

/// Whether the tetrahedron of the four points surely holds the ball of that radius about the origin. "No" says nothing: the
/// ball may be there all the same. Plain double with one bound for each face, then a running bound where that is too wide.
///
/// cost  about 40 ns, 150 where the second is asked
bool surely_holds_ball(const DifferencePoint* corner, double radius_m);

}  // namespace collided::engine::kernel
