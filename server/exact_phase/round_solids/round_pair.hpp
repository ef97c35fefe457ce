#pragma once

#include "server/exact_phase/distance/convex.hpp"

namespace collided::engine::kernel {

/// Whether two convex sets, at least one of which has a round side other than a ball's, share a point: by exact algebra on
/// the doubles given, whatever they touch in.
///
/// returns  undecided for what has no closed form here: the side of a cone against round solids, where axes are not
///          parallel; and a cylinder or capsule that touches so near to the end of its side that double does not tell
///          on which side of the end
/// cost     10 us to some ms; allocates
ExactResult round_sets_meet(const Convex& a, const Convex& b);

}  // namespace collided::engine::kernel
