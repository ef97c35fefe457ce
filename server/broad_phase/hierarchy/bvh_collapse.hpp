#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/broad_phase/hierarchy/bvh_node.hpp"
#include "server/broad_phase/hierarchy/bvh_split.hpp"

namespace collided::engine::bvh {

/// Cuts a small range in two repeatedly down to leaves, and chooses, among all ways to merge these cuts into wide
/// nodes, the one whose nodes a ray is expected to visit least: each node is weighted by the surface of its box.
///
/// cost    28 sums per cut; 160 bytes for each while it lives
/// source  Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017, 3.1
class Collapse {
 public:
  /// The largest depth of binary cuts, and so of wide nodes.
  static constexpr std::uint32_t kMostDepth = 36;
  static constexpr std::uint32_t kMostPrimitives = 2048;

  /// Cuts the range, which may have at most kMostPrimitives, and reorders its primitives.
  void cut(std::span<Primitive> primitives, const Range& range);

  static constexpr int kRoot = 0;
  const Range& range(int part) const { return parts_[static_cast<std::size_t>(part)].range; }
  bool is_leaf(int part) const { return parts_[static_cast<std::size_t>(part)].left < 0; }
  /// For an inner part: writes the parts that become its node's children and the cuts between them; returns the number
  /// of children.
  int children(int part, int (&out)[kWidth], Cut (&cuts)[kWidth]) const;

 private:
  struct Part {
    Range range;
    int left = -1;  // -1: a leaf
    int right = -1;
    int axis = 0;
    std::array<float, kWidth> cost{};                // [i]: as at most i children of a node; [0] is unused
    std::array<std::uint8_t, kWidth + 1> to_left{};  // [i]: how many of i children go left; 0: fewer than i are as good
  };

  int cut_further(std::span<Primitive> primitives, const Range& range, std::uint32_t depth);
  void weigh(Part& part) const;
  void gather(int part, int room, int at, int (&out)[kWidth], Cut (&cuts)[kWidth], int& count) const;

  std::vector<Part> parts_;
};

}  // namespace collided::engine::bvh
