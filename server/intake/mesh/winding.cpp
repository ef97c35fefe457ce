#include "server/intake/mesh/winding.hpp"

#include <utility>

#include "server/intake/disjoint_sets.hpp"

namespace collided::engine {
namespace {

/// Sets of triangles that record for each triangle whether it is turned over relative to the set's representative.
class ParitySets {
 public:
  explicit ParitySets(std::size_t count) : parents_(count), turned_(count, 0), contradicts_(count, 0) {
    std::iota(parents_.begin(), parents_.end(), 0u);
  }

  std::pair<std::uint32_t, bool> find(std::uint32_t triangle) {
    std::uint32_t root = triangle;
    bool turned = false;
    for (; parents_[root] != root; root = parents_[root]) turned ^= turned_[root] != 0;
    // Path compression: everything on the path is put directly below the root.
    for (bool rest = turned; parents_[triangle] != root && triangle != root;) {
      const bool own = turned_[triangle] != 0;
      const std::uint32_t next = parents_[triangle];
      parents_[triangle] = root;
      turned_[triangle] = rest ? 1 : 0;
      rest ^= own;
      triangle = next;
    }
    return {root, turned};
  }

  void join(std::uint32_t a, std::uint32_t b, bool is_turned) {
    const auto [first, turned_a] = find(a);
    const auto [second, turned_b] = find(b);
    const bool turned = turned_a ^ turned_b ^ is_turned;
    if (first == second) {
      contradicts_[first] |= turned ? 1 : 0;
      return;
    }
    const std::uint32_t low = std::min(first, second);
    const std::uint32_t high = std::max(first, second);
    parents_[high] = low;
    turned_[high] = turned ? 1 : 0;
    contradicts_[low] |= contradicts_[high];
  }

  bool contradicts(std::uint32_t root) const { return contradicts_[root] != 0; }

 private:
  std::vector<std::uint32_t> parents_;
  std::vector<std::uint8_t> turned_;  // relative to the parent
  std::vector<std::uint8_t> contradicts_;
};

}  // namespace

Orientation orientation_of(std::size_t triangle_count, const EdgeTable& table) {
  ParitySets sets(triangle_count);
  bool all_agree = true;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto uses = table.uses_of(i);
    if (uses.size() != 2) continue;
    const bool turned = table.is_inconsistent(i);
    all_agree = all_agree && !turned;
    sets.join(triangle_of(uses[0]), triangle_of(uses[1]), turned);
  }
  Orientation result;
  if (all_agree) return result;
  std::vector<std::int64_t> surplus(triangle_count, 0);  // by root: triangles that agree with it, minus the others
  for (std::uint32_t i = 0; i < triangle_count; ++i) {
    const auto [root, turned] = sets.find(i);
    surplus[root] += turned ? -1 : 1;
  }
  for (std::uint32_t i = 0; i < triangle_count; ++i) {
    const auto [root, turned] = sets.find(i);
    if (sets.contradicts(root)) {
      result.unorientable_count += root == i ? 1 : 0;
    } else if (turned == (surplus[root] >= 0)) {
      result.flipped.push_back(i);
    }
  }
  return result;
}

std::vector<std::uint32_t> pinched_points(const TriangleMesh& mesh, const EdgeTable& table,
                                          const std::vector<std::uint32_t>& point_of) {
  // Sets of corners, with the number of the half-edge that leaves them. Corners of triangles that share an edge at the
  // point are joined, so a set is a fan.
  DisjointSets fans(3 * mesh.triangles.size());
  const auto corner_at = [&](HalfEdge half, std::uint32_t point) {
    const std::uint32_t triangle = triangle_of(half);
    return point_of[mesh.triangles[triangle][half % 3]] == point ? half : 3 * triangle + (half % 3 + 1) % 3;
  };
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto uses = table.uses_of(i);
    for (std::size_t k = 1; k < uses.size(); ++k) {
      for (const std::uint32_t point : {table.edges[i].low, table.edges[i].high}) {
        fans.join(corner_at(uses[0], point), corner_at(uses[k], point));
      }
    }
  }
  std::vector<std::uint8_t> fan_counts(mesh.vertices.size(), 0);  // up to 2, which is enough
  for (const HalfEdge half : table.uses) {
    if (fans.find(half) != half) continue;
    std::uint8_t& count = fan_counts[point_of[mesh.triangles[triangle_of(half)][half % 3]]];
    count = count < 2 ? count + 1 : count;
  }
  std::vector<std::uint32_t> pinched;
  for (std::uint32_t i = 0; i < fan_counts.size(); ++i) {
    if (fan_counts[i] > 1) pinched.push_back(i);
  }
  return pinched;
}

}  // namespace collided::engine
