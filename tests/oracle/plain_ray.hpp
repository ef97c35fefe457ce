#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::oracle {
using namespace engine;

/// The parameter at which a ray meets a triangle, either side, in plain double: right but for rounding, and for
/// coordinates whose cubes fit a double. Zero-area triangles are missed.
///
/// source  Moeller, Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997
inline std::optional<double> plain_ray(const Ray& ray, const Triangle& triangle) {
  const Vec3 edge1 = triangle.b - triangle.a;
  const Vec3 edge2 = triangle.c - triangle.a;
  const Vec3 p = ray.direction.cross(edge2);
  const double det = edge1.dot(p);
  if (det == 0) return std::nullopt;
  const Vec3 from = ray.origin - triangle.a;
  const double u = from.dot(p) / det;
  const Vec3 q = from.cross(edge1);
  const double v = ray.direction.dot(q) / det;
  const double s = edge2.dot(q) / det;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && s >= 0)) return std::nullopt;
  return s;
}

}  // namespace collided::oracle
