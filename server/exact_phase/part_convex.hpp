#pragma once

#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/part.hpp"

namespace collided::engine {

/// The part as what all convex shapes are; of a half-space its point. Keeps a pointer to the part's hull.
kernel::Convex convex_of(const ConvexPart& part);

}  // namespace collided::engine
