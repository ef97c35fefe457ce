#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// The boxes of triangles that change while a mesh is simplified: a binary tree over the triangles in spatial order,
/// whose inner boxes only grow. It finds every triangle whose box overlaps a given one, and few more.
///
/// memory   about 40 bytes a triangle
/// threads  one at a time
class GrowingTree {
 public:
  /// Discards the old tree and builds one over these triangles only.
  void build(const std::vector<Vec3>& vertices, const std::vector<TriangleCorners>& corners,
             const std::vector<std::uint32_t>& triangles);

  /// Changes a triangle's box.
  /// cost  a step up the tree for each box that has to grow
  void update(std::uint32_t triangle, const Aabb& bounds);

  /// Removes the triangle from later searches.
  void remove(std::uint32_t triangle) { own_boxes_[place_of_[triangle]] = Box{}; }

  /// An overlap that find() found: number asked_index of the boxes given, and a triangle.
  struct Meeting {
    std::uint32_t asked_index;
    std::uint32_t triangle;
  };
  /// Appends the pairs of a given box and a triangle whose box overlaps it, both rounded outward to floats.
  void find(std::span<const Aabb> asked, std::vector<Meeting>& found);

 private:
  static constexpr float kEndless = std::numeric_limits<float>::infinity();

  /// A box relative to origin_, in floats rounded outward. An empty box is from +inf to -inf: it overlaps nothing.
  struct Box {
    Eigen::Array3f low = Eigen::Array3f::Constant(kEndless);
    Eigen::Array3f high = Eigen::Array3f::Constant(-kEndless);
  };
  static constexpr std::uint32_t kLeafTriangles = 8;

  Box box_of(const Aabb& bounds) const;
  static void extend(Box& box, const Box& more);
  static bool contains(const Box& box, const Box& inner);
  /// Without branches, since neither outcome is likely enough to be predicted.
  static bool overlaps(const Box& a, const Box& b) {
    return (a.low[0] <= b.high[0]) & (b.low[0] <= a.high[0]) & (a.low[1] <= b.high[1]) & (b.low[1] <= a.high[1]) &
           (a.low[2] <= b.high[2]) & (b.low[2] <= a.high[2]);
  }
  void find_in_leaf(std::uint32_t leaf, const Box& all, std::vector<Meeting>& found) const;

  Vec3 origin_ = Vec3::Zero();
  std::uint32_t leaf_count_ = 0;         // a power of two
  std::vector<std::uint32_t> order_;     // triangles, kLeafTriangles per leaf
  std::vector<std::uint32_t> place_of_;  // by triangle: its index in order_
  std::vector<Box> own_boxes_;           // of the triangles, as in order_
  std::vector<Box> asked_;               // boxes given to find(); kept to reuse its memory
  std::vector<Box> boxes_;               // 1 is the root, 2 i and 2 i + 1 are the children of i
};

}  // namespace collided::engine
