#include "server/world/objects/self_intersections.hpp"

#include <algorithm>
#include <array>

#include "server/exact_phase/overlap/neighbours.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/overlap/parted_in_projection.hpp"
#include "server/intake/mesh/mesh_health.hpp"

namespace collided::engine {
namespace {

/// Corners that two triangles share: how many, and which of a equals which of b.
struct Common {
  int count = 0;
  std::array<int, 3> of_a{};
  std::array<int, 3> of_b{};
};

using Corners = std::array<const Vec3*, 3>;

Corners corners_of(const TriangleMesh& mesh, std::uint32_t i) {
  const TriangleCorners& numbers = mesh.triangles[i];
  return {&mesh.vertices[numbers[0]], &mesh.vertices[numbers[1]], &mesh.vertices[numbers[2]]};
}

Common common_corners(const Corners& a, const Corners& b) {
  Common common;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (a[i] != b[k] && *a[i] != *b[k]) continue;
      common.of_a[common.count] = i;
      common.of_b[common.count++] = k;
      break;
    }
  }
  return common;
}

/// The same triangle with its corners in the order first, second, remaining.
Triangle turned(const Corners& c, int first, int second) { return {*c[first], *c[second], *c[3 - first - second]}; }

/// True if two triangles meet beyond their shared corners.
bool meet(const TriangleMesh& mesh, std::uint32_t a, std::uint32_t b) {
  const Corners p = corners_of(mesh, a);
  const Corners q = corners_of(mesh, b);
  const Common common = common_corners(p, q);
  switch (common.count) {
    case 0: {
      const Triangle one{*p[0], *p[1], *p[2]};
      const Triangle other{*q[0], *q[1], *q[2]};
      return !parted_in_projection(one, other) && overlaps(one, other).yes();
    }
    case 1:
      return meet_beyond_corner(turned(p, common.of_a[0], (common.of_a[0] + 1) % 3),
                                turned(q, common.of_b[0], (common.of_b[0] + 1) % 3))
          .yes();
    case 2:
      return meet_beyond_edge(turned(p, common.of_a[0], common.of_a[1]), turned(q, common.of_b[0], common.of_b[1]))
          .yes();
    default: return false;
  }
}

struct SelfIntersectionSearch {
  const TriangleMesh& mesh;
  const SearchControl& control;
  std::vector<bool> is_flat;
  // triangles that were offered as a pair with themselves, which happens once each; measures progress
  std::uint64_t own_count = 0;
  SelfIntersections result{};

  /// Reports progress now and then. False: the search was cancelled.
  bool tell() const {
    constexpr std::uint64_t kSeldom = 0x4000;
    if (result.candidate_count % kSeldom != 0) return true;
    if (control.progress) control.progress(static_cast<double>(own_count) / static_cast<double>(is_flat.size()));
    return !control.cancelled || !control.cancelled();
  }

  bool operator()(std::uint32_t a, std::uint32_t b) {
    ++result.candidate_count;
    own_count += a == b ? 1 : 0;
    // A walk of the tree against itself offers each pair in both orders.
    if (a < b && !is_flat[a] && !is_flat[b] && meet(mesh, a, b)) result.pairs.push_back({a, b});
    result.is_complete = result.candidate_count < SelfIntersections::kMostCandidates &&
                         result.pairs.size() < SelfIntersections::kMostPairs && tell();
    return result.is_complete;
  }
};

}  // namespace

SelfIntersections self_intersections(const TriangleMesh& mesh, const Bvh& tree, const SearchControl& control) {
  SelfIntersectionSearch search{.mesh = mesh, .control = control, .is_flat = std::vector<bool>(mesh.triangles.size())};
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) search.is_flat[i] = has_zero_area(mesh.triangle(i));
  WalkCost cost;
  tree.walk_pairs(tree, Mat3::Identity(), Vec3::Zero(), 0, search, cost);
  std::vector<TrianglePair>& pairs = search.result.pairs;
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return std::move(search.result);
}

}  // namespace collided::engine
