#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/oracle/first_hit.hpp"

namespace collided::oracle {
using namespace engine;

/// The lecture's second form, the auto-partition: space is halved by the planes of the triangles themselves until no
/// cell has a triangle of its own. The triangles of a plane stay at its node; one on both sides is referred to from
/// both, whole: nothing is clipped, so nothing is rounded, and what it costs are references. Of a few triangles drawn
/// at random the plane with the fewest on both sides is taken. Cells at kMaxDepth, or beyond kMostReferences a
/// triangle in all, hold what is left: around a convex body every plane has all the others on one side.
///
/// source  Fuchs, Kedem, Naylor, "On Visible Surface Generation by A Priori Tree Structures", 1980;
///         Paterson, Yao, "Efficient Binary Space Partitions for Hidden-Surface Removal", 1990
class PolygonBsp {
 public:
  static constexpr int kMaxDepth = 200;
  static constexpr std::size_t kMostReferences = 40;

  PolygonBsp(const TriangleMesh& mesh, std::mt19937_64& random);

  /// Front to back along the ray: the side it starts on, the plane's own triangles, the other side.
  FirstHit first_hit(const Ray& ray, PlainCost& cost) const;

  /// Nodes in the order in which their cells hide each other, seen from the eye: nothing behind comes before.
  std::vector<std::uint32_t> front_to_back(const Vec3& eye) const;
  static constexpr std::uint32_t kNone = 0xffffffffu;
  /// The node that holds the triangle in the cell of one of its points; kNone where a plane is too near to tell the side.
  std::uint32_t node_of(std::uint32_t triangle, const Vec3& point) const;
  /// On which side of the triangle's plane a point is: 1 where its normal points to, -1, or 0 for too near to tell.
  int side_of(std::uint32_t triangle, const Vec3& point) const;

  std::size_t nodes() const { return nodes_.size(); }
  int depth() const { return depth_; }
  std::size_t references() const { return references_.size(); }
  std::size_t bytes() const { return nodes_.size() * sizeof(Node) + references_.size() * sizeof(std::uint32_t); }

 private:
  /// normal . p = offset; nearer than slack counts as both sides.
  struct Plane {
    Vec3 normal = Vec3::Zero();
    double offset = 0;
    double slack = 0;

    double height(const Vec3& p) const { return normal.dot(p) - offset; }
  };
  struct Node {
    Plane plane;  // normal 0: a leaf
    std::uint32_t first_reference = 0;
    std::uint32_t reference_count = 0;
    std::uint32_t front = kNone;
    std::uint32_t back = kNone;
  };
  struct Sides {
    std::vector<std::uint32_t> front, on, back;
  };
  struct Walk;

  Plane plane_of(std::uint32_t triangle) const;
  Sides sides_of(const Plane& plane, const std::vector<std::uint32_t>& triangles) const;
  Plane choose(const std::vector<std::uint32_t>& triangles, std::mt19937_64& random) const;
  std::uint32_t build(std::vector<std::uint32_t> triangles, int depth, std::mt19937_64& random);
  std::uint32_t add(const Plane& plane, const std::vector<std::uint32_t>& triangles);
  void walk(Walk& walk, std::uint32_t node, double from, double to) const;

  const TriangleMesh& mesh_;
  double reach_ = 0;  // largest coordinate
  int depth_ = 0;
  std::size_t waiting_ = 0;  // references in cells that are still to be built
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> references_;
};

}  // namespace collided::oracle
