#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided {

/// Boxes of triangles that grow while a mesh is simplified: a binary tree over triangles in the order of their places,
/// whose boxes are only ever extended. Finds every triangle whose box overlaps an asked one, and some more.
///
/// memory  about 14 bytes a triangle
/// source  order: Morton, "A computer oriented geodetic data base", 1966
class GrowingTree {
 public:
  /// Over those triangles; the others are not in it. Starts anew.
  void build(const std::vector<Vec3>& vertices, const std::vector<TriangleCorners>& corners,
             const std::vector<std::uint32_t>& triangles);

  /// The triangle has a corner at that point from now on. cost: a step up the tree for each box that has to grow
  void extend(std::uint32_t triangle, const Vec3& point);

  /// Appends the triangles whose leaf's box overlaps the asked one.
  void find(const Vec3& low, const Vec3& high, std::vector<std::uint32_t>& found) const;

 private:
  /// Floats about the origin, rounded outward.
  struct Box {
    std::array<float, 3> low;
    std::array<float, 3> high;
  };
  static constexpr std::uint32_t kLeafTriangles = 4;

  Box box_of(const Vec3& low, const Vec3& high) const;
  static void extend(Box& box, const Box& more);
  static bool contains(const Box& box, const Box& inner);
  static bool overlaps(const Box& a, const Box& b);
  void sort_by_place(const std::vector<Vec3>& vertices, const std::vector<TriangleCorners>& corners);

  Vec3 origin_ = Vec3::Zero();
  std::uint32_t leaf_count_ = 0;          // a power of two
  std::vector<std::uint32_t> order_;      // triangles, kLeafTriangles a leaf
  std::vector<std::uint32_t> leaf_of_;    // by triangle
  std::vector<Box> boxes_;                // 1 is the root, 2 i and 2 i + 1 are the children of i
};

}  // namespace collided
