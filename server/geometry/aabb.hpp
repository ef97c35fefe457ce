#pragma once

#include <limits>

#include "server/geometry/shapes.hpp"
#include "server/geometry/vector.hpp"

namespace collided::engine {

/// Axis-aligned box {x : low <= x <= high}, closed. Empty if low > high on some axis, or a bound is NaN.
struct Aabb {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());

  bool empty() const { return !(low.array() <= high.array()).all(); }
  void extend(const Vec3& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  void extend(const Aabb& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
};

/// Whether two boxes share a point; touching counts.
inline bool overlaps(const Aabb& a, const Aabb& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

/// A box that contains every point of the shape: each bound is rounded outward.
Aabb bounds(const Sphere& sphere);
Aabb bounds(const Box& box);
Aabb bounds(const Capsule& capsule);
Aabb bounds(const Cylinder& cylinder);
Aabb bounds(const Cone& cone);
Aabb bounds(const Ellipsoid& ellipsoid);
Aabb bounds(const Hull& hull);
/// Infinite, unless the normal lies along an axis: then the box ends at the plane.
Aabb bounds(const HalfSpace& half_space);
Aabb bounds(const Triangle& triangle);
Aabb bounds(const Primitive& primitive);

/// Contains every point of the half-space in the box, which must be finite; empty only if there is none.
Aabb bounds_within(const HalfSpace& half_space, const Aabb& box);

/// The box grown by margin_m on each side, rounded outward.
Aabb grown(const Aabb& box, double margin_m);

}  // namespace collided::engine
