#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/mesh.hpp"

namespace collided {

/// Boxes of triangles that change while a mesh is simplified: a binary tree over triangles in the order of their places,
/// whose boxes are only ever extended. Finds every triangle whose box overlaps an asked one, and few more.
///
/// memory  about 40 bytes a triangle
class GrowingTree {
 public:
  /// Over those triangles; the others are not in it. Starts anew.
  void build(const std::vector<Vec3>& vertices, const std::vector<TriangleCorners>& corners,
             const std::vector<std::uint32_t>& triangles);

  /// That is the triangle's box from now on. cost: a step up the tree for each box that has to grow
  void update(std::uint32_t triangle, const Aabb& bounds);

  /// Appends the triangles whose box, rounded outward to floats, overlaps the asked one.
  void find(const Aabb& asked, std::vector<std::uint32_t>& found) const;

 private:
  /// Floats about the origin, rounded outward.
  struct Box {
    Eigen::Array3f low;
    Eigen::Array3f high;
  };
  static constexpr std::uint32_t kLeafTriangles = 8;

  Box box_of(const Aabb& bounds) const;
  static void extend(Box& box, const Box& more);
  static bool contains(const Box& box, const Box& inner);
  static bool overlaps(const Box& a, const Box& b);

  Vec3 origin_ = Vec3::Zero();
  std::uint32_t leaf_count_ = 0;          // a power of two
  std::vector<std::uint32_t> order_;      // triangles, kLeafTriangles a leaf
  std::vector<std::uint32_t> place_of_;   // in that order, by triangle
  std::vector<Box> own_boxes_;            // of the triangles, in that order
  std::vector<Box> boxes_;                // 1 is the root, 2 i and 2 i + 1 are the children of i
};

}  // namespace collided
