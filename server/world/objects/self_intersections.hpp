#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// Two triangles of one mesh with more points in common than the corners and the edge they share.
struct TrianglePair {
  std::uint32_t a = 0;  // a < b
  std::uint32_t b = 0;
  bool operator==(const TrianglePair&) const = default;
  auto operator<=>(const TrianglePair&) const = default;  // NOLINT(modernize-use-nullptr): it compares with 0
};

/// Result of the search, and whether it finished.
struct SelfIntersections {
  std::vector<TrianglePair> pairs;  // ascending
  std::uint64_t candidate_count = 0;
  // false: cancelled, or stopped at kMostPairs or kMostCandidates, which bound memory and time for triangle soups
  bool is_complete = true;

  static constexpr std::size_t kMostPairs = 10'000'000;
  static constexpr std::uint64_t kMostCandidates = 1'000'000'000;
};

/// Progress and cancellation of a long search; both are called now and then.
struct SearchControl {
  std::function<void(double)> progress{};  // fraction done in [0, 1]
  std::function<bool()> cancelled{};       // true ends the search with the result so far
};

/// Every pair of triangles that meet where they should not; exact, touching included. Corners with equal coordinates
/// count as one. Leaves out triangles without area and pairs with the same three points: mesh_health.hpp reports those.
///
/// tree      of the mesh
/// cost      about 0.6 us per triangle of a clean closed mesh
/// threads   one; the result does not depend on the tree
SelfIntersections self_intersections(const TriangleMesh& mesh, const Bvh& tree, const SearchControl& control = {});

}  // namespace collided::engine
