#pragma once

#include "server/exact_phase/distance/simplex_search.hpp"

namespace collided::engine::kernel {

/// Directions across which two convex sets may be apart, and points that they may share, as found by the search in
/// plain double, for sets with round parts. The caller must test each exactly.
struct Witnesses {
  Vec3 normal[4];
  Vec3 point[10];

  Witnesses(const Convex& a, const Convex& b, const Proposal& proposal, const DepthProposal& depth);
  /// Runs the search itself.
  Witnesses(const Convex& a, const Convex& b);
};

}  // namespace collided::engine::kernel
