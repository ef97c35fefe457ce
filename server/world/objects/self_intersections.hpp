#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// Two triangles of one mesh that have more in common than the corners they share.
struct TrianglePair {
  std::uint32_t a = 0;  // a < b
  std::uint32_t b = 0;
  bool operator==(const TrianglePair&) const = default;
  auto operator<=>(const TrianglePair&) const = default;
};

struct SelfIntersections {
  std::vector<TrianglePair> pairs;  // ascending
  std::uint64_t candidate_count = 0;
  // false: cancelled, or ended at kMostPairs or kMostCandidates, so that soups cannot take all memory or for ever
  bool is_complete = true;

  static constexpr std::size_t kMostPairs = 10'000'000;
  static constexpr std::uint64_t kMostCandidates = 1'000'000'000;
};

/// What a long search is told and asked, now and then.
struct SearchControl {
  std::function<void(double)> progress{};  // fraction done in [0, 1]
  std::function<bool()> cancelled{};       // true ends it with what has been found
};

/// Every pair of triangles that meet where they should not: exact, touching included. Equal coordinates are one corner.
/// Triangles without area and pairs with the same three points are left out: those are told by themselves
/// (mesh_health.hpp).
///
/// tree      of the mesh
/// cost      about 0.6 us a triangle of a clean closed mesh
/// threads   one; the result does not depend on the tree
SelfIntersections self_intersections(const TriangleMesh& mesh, const Bvh& tree, const SearchControl& control = {});

}  // namespace collided::engine
