#include "server/broad_phase/hierarchy/bvh_check.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <mutex>
#include <string_view>
#include <vector>

#include "server/broad_phase/hierarchy/bvh_pieces.hpp"
#include "server/broad_phase/hierarchy/bvh_primitive.hpp"
#include "server/broad_phase/hierarchy/bvh_threads.hpp"

namespace collided::engine::bvh {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct NodeBox {
  float low[3];
  float high[3];

  /// False with any NaN.
  bool contains(const Float4& other_low, const Float4& other_high) const {
    bool all = true;
    for (int axis = 0; axis < 3; ++axis) all = all && low[axis] <= other_low[axis] && other_high[axis] <= high[axis];
    return all;
  }
};

NodeBox box_of(const Node& node, int slot) {
  NodeBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = node.plane[axis][0][slot];
    box.high[axis] = node.plane[axis][1][slot];
  }
  return box;
}

bool is_nothing(const NodeBox& box) {
  bool all = true;
  for (int axis = 0; axis < 3; ++axis) all = all && box.low[axis] == kInfinity && box.high[axis] == -kInfinity;
  return all;
}

/// A reference to part of a triangle, in a leaf whose box does not contain the whole triangle.
struct PartialReference {
  std::uint32_t triangle;
  NodeBox box;
};

/// The parent of a leaf, and the number of triangles that its reference claims.
struct LeafPlace {
  NodeBox box;
  int count = 0;
};

bool names_each_child_once(std::uint32_t order) {
  unsigned seen = 0;
  for (int i = 0; i < kWidth; ++i) seen |= 1u << (order >> (3 * i) & 7u);
  return seen == 0xff;
}

bool has_good_orders(const Node& node) {
  bool all = names_each_child_once(node.occlusion_order());
  for (const std::uint32_t order : node.order) all = all && names_each_child_once(order);
  for (int i = 3; i < kWidth; ++i) all = all && node.order[i] >> (3 * kWidth) == 0;
  return all;
}

/// One check; run() returns the first flaw.
class Check {
 public:
  Check(const Layout& layout, const TriangleMesh& mesh, unsigned threads)
      : layout_(layout), mesh_(mesh), threads_(threads), places_(layout.leaves.size()) {}

  std::string_view run(BvhReport& report) {
    depth_.assign(layout_.nodes.size(), 0);
    for (const auto step : {&Check::check_root, &Check::check_nodes, &Check::check_leaves, &Check::check_triangles}) {
      std::string_view flaw = (this->*step)();
      if (!flaw.empty()) return flaw;
    }
    report.depth = deepest_ + 1;
    report.nodes = static_cast<std::uint32_t>(layout_.nodes.size());
    report.leaves = static_cast<std::uint32_t>(layout_.leaves.size());
    report.bytes = layout_.nodes.bytes() + layout_.leaves.bytes();
    report.split_triangles = static_cast<std::uint32_t>(layout_.splits.size());
    for (const LeafPlace& place : places_) report.references += static_cast<std::uint64_t>(place.count);
    return {};
  }

 private:
  std::string_view check_root() {
    NodeBox root;
    for (int axis = 0; axis < 3; ++axis) {
      root.low[axis] = layout_.root_low[axis];
      root.high[axis] = layout_.root_high[axis];
      // Every vertex is within [-1, 1], which the walks' bounds on rounding rely on.
      if (!(root.low[axis] >= -1 && root.low[axis] <= root.high[axis] && root.high[axis] <= 1)) {
        return "the root's box is not within the scene";
      }
    }
    // A walk from another node would miss the rest of the tree.
    const bool leads = layout_.nodes.size() == 0 ? is_leaf(layout_.root) : layout_.root == 0;
    if (!leads) return "the root is not the first node";
    return hang(layout_.root, root, 0, 0);
  }

  /// Records a child, and checks that no other parent has it. first: the lowest number allowed for an inner child.
  std::string_view hang(Ref ref, const NodeBox& box, std::uint32_t depth, std::size_t first) {
    if (depth + 1 > kMaxDepth) return "a path is too deep";
    deepest_ = std::max(deepest_, depth);
    if (is_leaf(ref)) {
      const std::size_t leaf = ref & kIndexMask;
      if (leaf >= places_.size()) return "a child is a leaf beyond the last";
      if (places_[leaf].count != 0) return "a leaf hangs twice";
      places_[leaf] = {box, leaf_count(ref)};
      ++hung_leaves_;
      return {};
    }
    // Forward only, so there are no cycles; once only, so no node has two paths to it.
    if (ref < first || ref >= layout_.nodes.size()) return "a child is a node that does not follow its parent";
    if (depth_[ref] != 0) return "a node hangs twice";
    depth_[ref] = static_cast<std::uint8_t>(depth);
    const Node& node = layout_.nodes[ref];
    for (int slot = 0; slot < kWidth; ++slot) {
      const NodeBox inner = box_of(node, slot);
      if (node.child[slot] == kNothing) {
        if (!is_nothing(inner)) return "a missing child has a box";
        continue;
      }
      for (int axis = 0; axis < 3; ++axis) {
        const bool fits = box.low[axis] <= inner.low[axis] && inner.low[axis] <= inner.high[axis] &&
                          inner.high[axis] <= box.high[axis];
        if (!fits) return "a box does not contain the boxes below it";
      }
    }
    return {};
  }

  std::string_view check_nodes() {
    for (std::size_t i = 0; i < layout_.nodes.size(); ++i) {
      std::string_view flaw = check_node(i);
      if (!flaw.empty()) return flaw;
    }
    return hung_leaves_ == layout_.leaves.size() ? "" : "a leaf hangs nowhere";
  }

  std::string_view check_node(std::size_t number) {
    if (number != 0 && depth_[number] == 0) return "a node hangs nowhere";
    const Node& node = layout_.nodes[number];
    if (!has_good_orders(node)) return "an order does not name each child once";
    for (int slot = 0; slot < kWidth; ++slot) {
      if (node.child[slot] == kNothing) continue;
      std::string_view flaw = hang(node.child[slot], box_of(node, slot), depth_[number] + 1u, number + 1);
      if (!flaw.empty()) return flaw;
    }
    return {};
  }

  /// Compares each leaf's stored triangles with the mesh.
  std::string_view check_leaves() {
    constexpr std::size_t kRun = 4096;
    std::mutex mutex;
    std::string_view flaw;
    is_held_.assign(mesh_.triangles.size(), 0);
    in_runs(threads_, places_.size(), kRun, [&](std::size_t begin, std::size_t end) {
      std::vector<PartialReference> partial;
      std::string_view own_flaw;
      for (std::size_t i = begin; i < end && own_flaw.empty(); ++i) own_flaw = check_leaf(i, partial);
      const std::lock_guard lock(mutex);
      if (flaw.empty()) flaw = own_flaw;
      partial_.insert(partial_.end(), partial.begin(), partial.end());
    });
    return flaw;
  }

  std::string_view check_leaf(std::size_t number, std::vector<PartialReference>& partial) {
    const Leaf& leaf = layout_.leaves[number];
    const LeafPlace& place = places_[number];
    Leaf expected{};
    for (int lane = 0; lane < place.count; ++lane) {
      const std::uint32_t triangle = leaf.triangle[lane];
      if (triangle >= mesh_.triangles.size()) return "a leaf has a triangle beyond the last";
      set_lane(mesh_, layout_.frame, layout_.has_corners, triangle, lane, expected);
      const Primitive whole = local_primitive(mesh_, layout_.frame, triangle);
      if (place.box.contains(whole.low, whole.high)) {
        // Several leaves may hold the triangle; all write the same value.
        std::atomic_ref(is_held_[triangle]).store(1, std::memory_order_relaxed);
      } else {
        partial.push_back({triangle, place.box});
      }
    }
    // Bit by bit, as they were written: NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
    return std::memcmp(&leaf, &expected, sizeof(Leaf)) == 0 ? "" : "a leaf's corners are not the mesh's";
  }

  /// Every triangle must be in a leaf that contains it, or each of its pieces in a leaf that refers to it.
  std::string_view check_triangles() {
    std::sort(partial_.begin(), partial_.end(),
              [](const PartialReference& a, const PartialReference& b) { return a.triangle < b.triangle; });
    std::uint64_t before = 0;
    for (const Split& split : layout_.splits) {
      if (split.triangle >= mesh_.triangles.size() || split.triangle < before || split.piece_count < 2 ||
          split.piece_count > kMaxPieces) {
        return "the split triangles are not in order";
      }
      before = std::uint64_t{split.triangle} + 1;
      if (is_held_[split.triangle] == 0) is_held_[split.triangle] = is_covered(split) ? 1 : 0;
    }
    const bool all = std::all_of(is_held_.begin(), is_held_.end(), [](std::uint8_t held) { return held != 0; });
    return all ? "" : "a triangle is not in the boxes of its leaves";
  }

  bool is_covered(const Split& split) const {
    struct ByTriangle {
      bool operator()(const PartialReference& a, std::uint32_t b) const { return a.triangle < b; }
      bool operator()(std::uint32_t a, const PartialReference& b) const { return a < b.triangle; }
    };
    const auto parts = std::equal_range(partial_.begin(), partial_.end(), split.triangle, ByTriangle{});
    Primitive pieces[kMaxPieces];
    const std::uint32_t count = cover(mesh_, layout_.frame, split.triangle, split.piece_count, pieces);
    return std::all_of(pieces, pieces + count, [&](const Primitive& piece) {
      return std::any_of(parts.first, parts.second,
                         [&](const PartialReference& part) { return part.box.contains(piece.low, piece.high); });
    });
  }

  const Layout& layout_;
  const TriangleMesh& mesh_;
  unsigned threads_;
  std::vector<std::uint8_t> depth_;  // 0 until the node is attached
  std::vector<LeafPlace> places_;    // count 0 until the leaf is attached
  std::vector<std::uint8_t> is_held_;
  std::vector<PartialReference> partial_;
  std::uint64_t hung_leaves_ = 0;
  std::uint32_t deepest_ = 0;
};

}  // namespace

std::string flaw_of(const Layout& layout, const TriangleMesh& mesh, unsigned threads, BvhReport& report) {
  return std::string(Check(layout, mesh, threads).run(report));
}

}  // namespace collided::engine::bvh
