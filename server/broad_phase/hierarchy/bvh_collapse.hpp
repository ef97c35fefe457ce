#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/broad_phase/hierarchy/bvh_split.hpp"

namespace collided::engine::bvh {

/// A cut that made a node's children: child `left` was cut along an axis, its upper part became `right`.
struct Cut {
  int left;
  int right;
  int axis;
};

/// A small range cut in two down to its leaves, and of all ways to gather these cuts into wide nodes the one whose nodes
/// a ray is expected to meet least often: each weighs as the surface of its box.
///
/// cost    28 sums a cut; 160 bytes for each while it lasts
/// source  Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017, 3.1
class Collapse {
 public:
  /// The most that binary cuts, and so wide nodes, may lie below each other.
  static constexpr std::uint32_t kMostDepth = 36;
  static constexpr std::uint32_t kMostPrimitives = 2048;

  /// Reorders the primitives of the range, at most kMostPrimitives.
  void cut(std::span<Primitive> primitives, const Range& range);

  static constexpr int kRoot = 0;
  const Range& range(int part) const { return parts_[static_cast<std::size_t>(part)].range; }
  bool is_leaf(int part) const { return parts_[static_cast<std::size_t>(part)].left < 0; }
  /// Of a part that is no leaf: the parts that become its node's children, and the cuts between them.
  int children(int part, int (&out)[kWidth], Cut (&cuts)[kWidth]) const;

 private:
  struct Part {
    Range range;
    int left = -1;  // none: a leaf
    int right = -1;
    int axis = 0;
    std::array<float, kWidth> cost{};                // [i]: as at most i children of a node; [0] unused
    std::array<std::uint8_t, kWidth + 1> to_left{};  // [i]: how many of i children go left; 0: fewer than i do as well
  };

  int cut_further(std::span<Primitive> primitives, const Range& range, std::uint32_t depth);
  void weigh(Part& part) const;
  void gather(int part, int room, int at, int (&out)[kWidth], Cut (&cuts)[kWidth], int& count) const;

  std::vector<Part> parts_;
};

}  // namespace collided::engine::bvh
