#pragma once

#include <cstdint>

#include "server/exact_phase/arithmetic/dyadic.hpp"
#include "server/exact_phase/arithmetic/number.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// A plane of a solid's tree, defined exactly: of a triangle of the mesh, or across a coordinate axis. Its doubles only
/// serve the filter.
struct SplitPlane {
  static constexpr std::uint32_t kAcross = 0xfffffffd;  // kAcross + axis instead of a triangle: across that axis

  Vec3 normal = Vec3::Zero();  // towards the front, any length
  double offset = 0;           // normal . p for its points; across an axis, exactly the coordinate
  double error = 0;            // of normal . p - offset, for p in the box of the filter
  double normal_error = 0;     // of the normal's coordinates, summed
  std::uint32_t triangle = 0;

  /// The side of a point known up to `error_m` per coordinate, whose true place is in the box of the filter: 1 in
  /// front, -1 behind, 0 if double cannot decide.
  int quick_side(const Vec3& at, double error_m) const;

  bool is_across() const { return triangle >= kAcross; }
  int axis() const { return static_cast<int>(triangle - kAcross); }
};

/// The plane of a triangle with an area; its normal is on the side from which the corners run anticlockwise.
///
/// within  the filter's error holds for points in this box
SplitPlane plane_of_triangle(const TriangleMesh& mesh, std::uint32_t triangle, const Aabb& within);
/// The plane of all points with this coordinate; its front is where the coordinate is greater.
SplitPlane plane_across(int axis, double at);

/// The plane's coefficients in numbers N: normal . p - offset is 0 on it and greater on its front.
template <class N>
struct PlaneIn {
  kernel::Vector<N> normal;
  N offset;

  PlaneIn(const TriangleMesh& mesh, const SplitPlane& plane);
  N height(const Vec3& point) const { return dot(normal, kernel::Vector<N>(point)) - offset; }
};
using ExactPlane = PlaneIn<Dyadic>;
using BoundedPlane = PlaneIn<Bounded>;

}  // namespace collided::engine
