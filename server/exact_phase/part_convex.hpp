#pragma once

#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/part.hpp"

namespace collided::engine {

/// The part in the form common to all convex shapes; for a half-space, its point. Keeps a pointer to the part's hull,
/// which must outlive the result.
kernel::Convex convex_of(const ConvexPart& part);

}  // namespace collided::engine
