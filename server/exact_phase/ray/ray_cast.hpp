#pragma once

#include <algorithm>
#include <cmath>

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {

/// The first hit of a ray on a shape. |true distance - distance_m| <= distance_error_m.
struct RayHit {
  double distance_m = 0;
  double distance_error_m = 0;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();   // unit, against the ray; for a start inside a solid: the outward normal at the exit
  Vec3 weights = Vec3::Zero();  // barycentric, triangles only; their sum is 1 to one rounding
  double exit_m = 0;            // where the ray leaves a solid (may exceed its length); for a triangle the distance
  double exit_error_m = 0;      // bound on |true exit - exit_m|
  bool inside = false;          // the ray starts inside a solid: distance 0
};

/// A bound on |hit.point - true point|, for a hit that `cast_ray` filled. Computed on demand, not in every hit.
///
/// The point is o + x, with x the product of the distance and the unit direction (for a triangle of the parameter and
/// the direction, one rounding less). x is off by the distance's own error along the ray and by kPointOnRay of the
/// distance; the sum rounds each coordinate once more.
inline double point_error_m(const RayHit& hit) {
  if (hit.distance_m == 0 && hit.distance_error_m == 0) return 0;  // the ray's origin
  // Number by number: they were usually written just before, and a load of two would wait until those stores have
  // reached the cache.
  const double largest = std::max({std::abs(hit.point[0]), std::abs(hit.point[1]), std::abs(hit.point[2])});
  return (hit.distance_error_m + kPointOnRay * hit.distance_m + kPointSum * largest) * (1 + kBoundSlack) + kUnderflow;
}

/// Whether the ray meets the shape, exact for the given doubles; touching counts, and so do both ends of the ray and
/// both sides of a triangle. A triangle without area counts as a segment or point. Fills `hit` on yes only.
///
/// threads  pure; allocates only on Level::rational
ExactResult cast_ray(const Ray& ray, const Triangle& triangle, RayHit& hit);
ExactResult cast_ray(const Ray& ray, const Sphere& sphere, RayHit& hit);
ExactResult cast_ray(const Ray& ray, const Box& box, RayHit& hit);
ExactResult cast_ray(const Ray& ray, const Capsule& capsule, RayHit& hit);
ExactResult cast_ray(const Ray& ray, const Cylinder& cylinder, RayHit& hit);
ExactResult cast_ray(const Ray& ray, const Cone& cone, RayHit& hit);
ExactResult cast_ray(const Ray& ray, const Ellipsoid& ellipsoid, RayHit& hit);
/// A ray that does not leave again has an infinite exit.
ExactResult cast_ray(const Ray& ray, const HalfSpace& half_space, RayHit& hit);
/// Tests the placed faces, which are convex up to the rounding of placing them.
ExactResult cast_ray(const Ray& ray, const Hull& hull, RayHit& hit);

/// How much nearer or farther the hit may be on another shape whose points differ from those of this one by at most
/// placing_m, unless the hit is that close to an edge. Infinite if the ray is so flat to the surface that it may miss
/// the other shape.
///
/// corners  of the triangle hit; null: a solid
double placing_error_along(const Ray& ray, const RayHit& hit, double placing_m, const Triangle* corners);

/// Which of two triangles, both met by the ray, it meets first: -1 a, +1 b, 0 both at once. Exact.
int compare_hits(const Ray& ray, const Triangle& a, const Triangle& b);

}  // namespace collided::engine
