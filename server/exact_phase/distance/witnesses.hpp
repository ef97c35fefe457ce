#pragma once

#include "server/exact_phase/distance/simplex_search.hpp"

namespace collided::engine::kernel {

/// Directions across which two convex sets may be apart, and points that they may share: what the search in plain double
/// found, for sets with round parts. Each is then to be tested exactly.
struct Witnesses {
  Vec3 normal[4];
  Vec3 point[10];

  Witnesses(const Convex& a, const Convex& b, const Proposal& proposal, const DepthProposal& depth);
  /// Searches by itself.
  Witnesses(const Convex& a, const Convex& b);
};

}  // namespace collided::engine::kernel
