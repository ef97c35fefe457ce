#include "server/broad_phase/hierarchy/bvh_node.hpp"

#include <limits>

namespace collided::engine::bvh {
namespace {

/// The child to cut next: the one with the largest surface, or with the most triangles if only counts can divide; -1 if
/// each fits a leaf.
int next_cut(const Range (&children)[kWidth], int count, bool by_count) {
  int next = -1;
  for (int i = 0; i < count; ++i) {
    if (children[i].size() <= kWidth) continue;
    if (next < 0) {
      next = i;
      continue;
    }
    const float area = by_count ? 0.0f : children[i].bounds.half_area();
    const float best = by_count ? 0.0f : children[next].bounds.half_area();
    if (area > best || (area == best && children[i].size() > children[next].size())) next = i;
  }
  return next;
}

}  // namespace

void set_child(Node& node, int slot, const FloatBox& box, Ref ref) {
  for (int axis = 0; axis < 3; ++axis) {
    node.plane[axis][0][slot] = box.low[axis];
    node.plane[axis][1][slot] = box.high[axis];
  }
  node.child[slot] = ref;
}

Node empty_node() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Node node{};
  const FloatBox nothing{Float4::Constant(kInfinity), Float4::Constant(-kInfinity)};
  for (int slot = 0; slot < kWidth; ++slot) set_child(node, slot, nothing, kNothing);
  return node;
}

/// A child's list starts with itself; undoing the cuts from last to first joins the lists of the two sides, nearer side
/// first.
void set_order(const Cut (&cuts)[kWidth], int child_count, Node& node) {
  for (unsigned octant = 0; octant < 8; ++octant) {
    std::uint32_t list[kWidth];
    int length[kWidth];
    for (int i = 0; i < kWidth; ++i) {
      list[i] = static_cast<std::uint32_t>(i);
      length[i] = 1;
    }
    for (int c = child_count - 2; c >= 0; --c) {
      const auto [left, right, axis] = cuts[c];
      const bool left_first = (octant >> axis & 1u) == 0;
      const int first = left_first ? left : right;
      const int second = left_first ? right : left;
      list[left] = list[first] | list[second] << (3 * length[first]);
      length[left] += length[right];
    }
    // Missing children go last, so that every lane appears once.
    for (int i = child_count; i < kWidth; ++i) list[0] |= static_cast<std::uint32_t>(i) << (3 * i);
    node.order[octant] = list[0];
  }
}

int cut_wide(std::span<Primitive> primitives, const Range& range, bool by_count, Range (&children)[kWidth],
             Cut (&cuts)[kWidth]) {
  int count = 1;
  children[0] = range;
  while (count < kWidth) {
    const int next = next_cut(children, count, by_count);
    if (next < 0) break;
    const Range whole = children[next];
    const int axis = split(primitives, whole, by_count, children[next], children[count]);
    cuts[count - 1] = {next, count, axis};
    ++count;
  }
  return count;
}

}  // namespace collided::engine::bvh
