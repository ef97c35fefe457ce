#pragma once

#include <algorithm>
#include <cstdint>
#include <queue>
#include <span>
#include <vector>

#include "server/geometry/aabb.hpp"

namespace collided::engine {

/// A lower bound on the clearance of the contents of two boxes, metres: their gap; if they overlap, minus the shortest
/// translation along an axis that separates them, which no depth of two convex parts exceeds.
double least_clearance(const Aabb& a, const Aabb& b);

/// A binary tree over the boxes of some objects, for searches over pairs of objects. An empty box is in no leaf.
class BoundsTree {
 public:
  struct BoundsNode {
    Aabb bounds;
    std::uint32_t first = 0;   // child; in a leaf the number of the box
    std::uint32_t second = 0;  // child; 0: a leaf
    bool is_leaf() const { return second == 0; }
  };

  /// cost  n log n, splits at the middle object along the longest side
  explicit BoundsTree(std::span<const Aabb> boxes);

  bool empty() const { return nodes_.empty(); }
  const BoundsNode& node(std::uint32_t number) const { return nodes_[number]; }

 private:
  std::uint32_t build(std::span<const Aabb> boxes, std::span<std::uint32_t> numbers);

  std::vector<BoundsNode> nodes_;  // root first
};

/// Visits pairs of boxes of two trees, possibly nearest first, until no remaining pair may be within the limit. Best
/// first, so that the first pairs tested set a limit that excludes the rest.
///
/// limit_m  takes nothing, returns the current limit; pairs certainly farther are left out
/// visit    receives the two numbers and their lower bound; returns false to end the walk
/// source   Hjaltason, Samet, "Incremental distance join algorithms for spatial databases", SIGMOD 1998
template <class Limit, class Visit>
void walk_nearest_pairs(const BoundsTree& a, const BoundsTree& b, const Limit& limit_m, Visit&& visit) {
  struct NodePair {
    double least_m;
    std::uint32_t of_a;
    std::uint32_t of_b;
    bool operator<(const NodePair& other) const { return least_m > other.least_m; }  // the least on top of the heap
  };
  if (a.empty() || b.empty()) return;
  std::priority_queue<NodePair> waiting;
  const auto add = [&](std::uint32_t of_a, std::uint32_t of_b) {
    const double least_m = least_clearance(a.node(of_a).bounds, b.node(of_b).bounds);
    if (least_m <= limit_m()) waiting.push({least_m, of_a, of_b});
  };
  for (add(0, 0); !waiting.empty() && waiting.top().least_m <= limit_m();) {
    const NodePair next = waiting.top();
    waiting.pop();
    const BoundsTree::BoundsNode& of_a = a.node(next.of_a);
    const BoundsTree::BoundsNode& of_b = b.node(next.of_b);
    if (of_a.is_leaf() && of_b.is_leaf()) {
      if (!visit(of_a.first, of_b.first, next.least_m)) return;
      continue;
    }
    const auto size = [](const BoundsTree::BoundsNode& node) {
      return (node.bounds.high - node.bounds.low).maxCoeff();
    };
    if (of_b.is_leaf() || (!of_a.is_leaf() && size(of_a) > size(of_b))) {
      add(of_a.first, next.of_b);
      add(of_a.second, next.of_b);
    } else {
      add(next.of_a, of_b.first);
      add(next.of_a, of_b.second);
    }
  }
}

}  // namespace collided::engine
