#pragma once

#include "server/exact_phase/distance/simplex_search.hpp"

namespace collided::engine::kernel {

/// Whether the tetrahedron of the four points surely contains the ball of that radius about the origin. False proves
/// nothing: it may contain the ball all the same. Tries plain double with one bound per face, then a running bound.
///
/// cost  about 40 ns, 150 where the running bound is needed
bool surely_holds_ball(const DifferencePoint* corner, double radius_m);

}  // namespace collided::engine::kernel
