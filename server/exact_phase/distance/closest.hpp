#pragma once

#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// The nearest point of a closed set. |true distance - distance_m| <= distance_error_m; distance 0 inside a solid.
struct Closest {
  double distance_m = 0;
  double distance_error_m = 0;
  Vec3 point = Vec3::Zero();   // on the set, |true point - point| <= point_error_m
  Vec3 normal = Vec3::Zero();  // unit, from the set to the given point; for a point inside: of the nearest face
  double point_error_m = 0;
};

/// The point of a shape nearest to a given point; coordinates of both in one frame. Pure; any thread.
Closest closest(const Vec3& point, const Sphere& sphere);
Closest closest(const Vec3& point, const Box& box);
Closest closest(const Vec3& point, const Capsule& capsule);
Closest closest(const Vec3& point, const Triangle& triangle);
Closest closest(const Vec3& point, const Primitive& primitive);

}  // namespace collided::engine
