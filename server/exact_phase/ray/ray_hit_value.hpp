#pragma once

#include <algorithm>

#include "server/exact_phase/arithmetic/ladder.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"

namespace collided::engine::kernel {

// Results common to all solids that a ray meets.

template <class N>
Scaled length_of(const Ray& ray) {
  return sqrt(scaled(square(Vector<N>(ray.direction))));
}

inline Vec3 at_distance(const Ray& ray, double distance_m) { return ray.origin + distance_m * unit(ray.direction); }

/// Fills distances and the point; a start inside has distance 0. The normal is set separately.
inline void set_interval(const Ray& ray, bool inside, const Bounded& first, const Bounded& exit, RayHit& hit) {
  hit.inside = inside;
  hit.distance_m = inside ? 0.0 : first.value;
  hit.distance_error_m = inside ? 0.0 : first.bound();
  hit.exit_m = std::max(exit.value, hit.distance_m);
  // If rounding put the two in the wrong order, the truth is between the exit's value and the entry's bound.
  hit.exit_error_m = exit.bound() + (hit.exit_m - exit.value);
  hit.point = inside ? ray.origin : at_distance(ray, first.value);
  hit.weights = Vec3::Zero();
}

/// Sets the normal: outward at the exit for a start inside, else against the ray; `outward` is zero if the shape gives
/// no direction.
inline void set_normal(const Ray& ray, const Vec3& outward, RayHit& hit) {
  const Vec3 direction = unit(ray.direction);
  const Vec3 normal = unit(outward);
  hit.normal = normal.isZero(0) ? Vec3(hit.inside ? direction : -direction) : normal;
}

}  // namespace collided::engine::kernel
