#include "server/broad_phase/hierarchy/bvh_occlusion_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "server/broad_phase/hierarchy/bvh_threads.hpp"

namespace collided::engine::bvh {
namespace {

/// Leaves per batch of a thread.
constexpr std::size_t kLeavesARun = 16384;
// Relative costs of testing a node's eight boxes and a leaf's eight triangles.
constexpr float kNodeCost = 1;
constexpr float kLeafCost = 1.5f;

/// The expected result of a walk in a subtree.
struct Outlook {
  float surface = 0;  // area of its triangles, both sides
  float cost = 0;     // expected node steps to search it until a hit
};

/// The area of all triangles, both sides.
float surface_of(const Leaf& leaf, int count, bool has_corners) {
  float sum = 0;
  for (int lane = 0; lane < count; ++lane) {
    Eigen::Vector3f a, b, c;
    for (int axis = 0; axis < 3; ++axis) {
      a[axis] = leaf.a[axis][lane];
      b[axis] = leaf.b[axis][lane];
      c[axis] = leaf.c[axis][lane];
    }
    sum += (has_corners ? (b - a).cross(c - a) : b.cross(c)).norm();
  }
  return sum;
}

/// The surface of a child's box.
float box_surface(const Node& node, int slot) {
  std::array<float, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis) size[axis] = node.plane[axis][1][slot] - node.plane[axis][0][slot];
  return 2 * (size[0] * (size[1] + size[2]) + size[1] * size[2]);
}

/// The chance that a line through a box of surface `box` meets the triangles in it.
float chance_of_meeting(float surface, float box) { return box > 0 ? 1 - std::exp(-surface / box) : 1; }

class OcclusionOrders {
 public:
  explicit OcclusionOrders(Layout& layout)
      : layout_(layout), leaves_(layout.leaves.size()), nodes_(layout.nodes.size()) {}

  void look_at_leaves(unsigned threads) {
    std::vector<std::uint8_t> counts(leaves_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      for (const Ref ref : layout_.nodes[i].child) {
        if (ref != kNothing && is_leaf(ref)) counts[ref & kIndexMask] = static_cast<std::uint8_t>(leaf_count(ref));
      }
    }
    in_runs(threads, leaves_.size(), kLeavesARun, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        leaves_[i] = {surface_of(layout_.leaves[i], counts[i], layout_.has_corners), kLeafCost};
      }
    });
  }
  /// Goes backward: children have larger numbers than their parents.
  void order_nodes() {
    for (std::size_t i = nodes_.size(); i-- > 0;) nodes_[i] = order(layout_.nodes[i]);
  }

 private:
  const Outlook& outlook(Ref ref) const { return is_leaf(ref) ? leaves_[ref & kIndexMask] : nodes_[ref]; }

  Outlook order(Node& node) const {
    std::array<float, kWidth> merit, chance, box, cost;
    std::array<int, kWidth> turn;
    std::iota(turn.begin(), turn.end(), 0);
    Outlook whole;
    Eigen::Array3f low = Eigen::Array3f::Constant(3e38f);
    Eigen::Array3f high = -low;
    for (int slot = 0; slot < kWidth; ++slot) {
      const auto s = static_cast<std::size_t>(slot);
      merit[s] = -1;
      if (node.child[slot] == kNothing) continue;
      const Outlook& child = outlook(node.child[slot]);
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], node.plane[axis][0][slot]);
        high[axis] = std::max(high[axis], node.plane[axis][1][slot]);
      }
      box[s] = box_surface(node, slot);
      chance[s] = chance_of_meeting(child.surface, box[s]);
      cost[s] = child.cost;
      merit[s] = chance[s] / child.cost;
      whole.surface += child.surface;
    }
    std::stable_sort(turn.begin(), turn.end(), [&](int a, int b) {
      return merit[static_cast<std::size_t>(a)] > merit[static_cast<std::size_t>(b)];
    });
    const Eigen::Array3f size = high - low;
    const float area = 2 * (size[0] * (size[1] + size[2]) + size[1] * size[2]);
    whole.cost = kNodeCost;
    float unmet = 1;
    std::uint32_t list = 0;
    for (int i = 0; i < kWidth; ++i) {
      const auto s = static_cast<std::size_t>(turn[static_cast<std::size_t>(i)]);
      list |= static_cast<std::uint32_t>(s) << (3 * i);
      if (merit[s] < 0) continue;
      const float reached = area > 0 ? std::min(1.0f, box[s] / area) : 1.0f;
      whole.cost += unmet * reached * cost[s];
      unmet *= 1 - reached * chance[s];
    }
    node.set_occlusion_order(list);
    return whole;
  }

  Layout& layout_;
  std::vector<Outlook> leaves_;
  std::vector<Outlook> nodes_;
};

}  // namespace

void set_occlusion_orders(Layout& layout, unsigned threads) {
  OcclusionOrders orders(layout);
  orders.look_at_leaves(threads);
  orders.order_nodes();
}

}  // namespace collided::engine::bvh
