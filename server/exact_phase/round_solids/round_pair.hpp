#pragma once

#include "server/exact_phase/distance/convex.hpp"

namespace collided::engine::kernel {

/// Whether two convex sets, at least one of which has a round side other than a ball's, share a point: by exact algebra
/// on the given doubles, whatever features they touch in.
///
/// returns  undecided where no closed form is known here: the side of a cone against round solids, unless axes are
/// parallel; and a cylinder or capsule that touches so near to the end of its side that double cannot tell on which
/// side of the end
/// cost     10 us to some ms; allocates
ExactResult round_sets_meet(const Convex& a, const Convex& b);

}  // namespace collided::engine::kernel
