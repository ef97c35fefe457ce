#pragma once

#include "server/exact_phase/distance/simplex_search.hpp"

namespace collided::engine::kernel {

/// True if the tetrahedron of the four points certainly contains the ball of that radius around the origin. False
/// proves nothing. Tries plain double with one bound per face, then a running bound.
///
/// cost  about 40 ns, 150 if the running bound is needed
bool surely_holds_ball(const DifferencePoint* corner, double radius_m);

}  // namespace collided::engine::kernel
