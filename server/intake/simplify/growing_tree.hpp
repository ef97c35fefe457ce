#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// Boxes of triangles that change while a mesh is simplified: a binary tree over triangles in the order of their places,
/// whose boxes are only ever extended. Finds every triangle whose box overlaps one of those asked, and few more.
///
/// memory  about 40 bytes a triangle
class GrowingTree {
 public:
  /// Over those triangles; the others are not in it. Starts anew.
  void build(const std::vector<Vec3>& vertices, const std::vector<TriangleCorners>& corners,
             const std::vector<std::uint32_t>& triangles);

  /// That is the triangle's box from now on. cost: a step up the tree for each box that has to grow
  void update(std::uint32_t triangle, const Aabb& bounds);

  /// It is found no more.
  void remove(std::uint32_t triangle) { own_boxes_[place_of_[triangle]] = Box{}; }

  struct Meeting {
    std::uint32_t asked_index;
    std::uint32_t triangle;
  };
  /// Appends the triangles whose box overlaps an asked one, both rounded outward to floats, with which ones.
  void find(std::span<const Aabb> asked, std::vector<Meeting>& found);

 private:
  static constexpr float kEndless = std::numeric_limits<float>::infinity();

  /// Floats about the origin, rounded outward; from +inf to -inf, and overlapping nothing, where there is none.
  struct Box {
    Eigen::Array3f low = Eigen::Array3f::Constant(kEndless);
    Eigen::Array3f high = Eigen::Array3f::Constant(-kEndless);
  };
  static constexpr std::uint32_t kLeafTriangles = 8;

  Box box_of(const Aabb& bounds) const;
  static void extend(Box& box, const Box& more);
  static bool contains(const Box& box, const Box& inner);
  /// Without branches, since neither outcome is the likely one.
  static bool overlaps(const Box& a, const Box& b) {
    return (a.low[0] <= b.high[0]) & (b.low[0] <= a.high[0]) & (a.low[1] <= b.high[1]) & (b.low[1] <= a.high[1]) &
           (a.low[2] <= b.high[2]) & (b.low[2] <= a.high[2]);
  }
  void find_in_leaf(std::uint32_t leaf, const Box& all, std::vector<Meeting>& found) const;

  Vec3 origin_ = Vec3::Zero();
  std::uint32_t leaf_count_ = 0;         // a power of two
  std::vector<std::uint32_t> order_;     // triangles, kLeafTriangles a leaf
  std::vector<std::uint32_t> place_of_;  // in that order, by triangle
  std::vector<Box> own_boxes_;           // of the triangles, in that order
  std::vector<Box> asked_;               // of the question at work; kept for its memory
  std::vector<Box> boxes_;               // 1 is the root, 2 i and 2 i + 1 are the children of i
};

}  // namespace collided::engine
