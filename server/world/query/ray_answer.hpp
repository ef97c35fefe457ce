#pragma once

#include <cmath>
#include <limits>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/stable_length.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

// Shared by the two ways to answer a ray: ray_question.cpp for any ray, plain_rays.cpp for plain ones.

/// stable_length of a ray's direction, from three numbers in memory.
inline double length_of_direction(const double* n) {
  const double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  if (square > kSmallestPlain && square < kLargestPlain) [[likely]]
    return std::sqrt(square);
  return stable_length(Vec3(n[0], n[1], n[2]));
}

/// A ray's length in lengths of its direction, rounded up.
inline double limit_of(const Ray& ray) {
  if (ray.length_m == std::numeric_limits<double>::infinity()) return ray.length_m;
  return ray.length_m / length_of_direction(&ray.direction[0]) * (1 + kFewSlack);
}
/// False if a length divided by a denormal direction overflowed.
inline bool is_limit_known(const Ray& ray, double limit) {
  return ray.length_m == std::numeric_limits<double>::infinity() || limit <= std::numeric_limits<double>::max();
}
/// How far along the ray a hit may be nearer than this one by more than slack_m, in lengths of the direction, rounded
/// up.
inline double reach_of(const Ray& ray, const RayHit& hit, double slack_m) {
  return (hit.distance_m + hit.distance_error_m - slack_m) / length_of_direction(&ray.direction[0]) * (1 + kFewSlack);
}
/// Which of a hit and another point on the ray is nearer, if their intervals do not overlap: -1 the hit, +1 the other;
/// else 0.
inline int order_of(const RayHit& hit, double other_m, double other_error_m) {
  if (hit.distance_m + hit.distance_error_m < other_m - other_error_m) return -1;
  return other_m + other_error_m < hit.distance_m - hit.distance_error_m ? 1 : 0;
}

/// Copies number by number, as the numbers were written just before: a wider load would wait until those stores have
/// reached the cache.
inline Vec3 copied(const Vec3& v) { return {v[0], v[1], v[2]}; }

/// The hit in the form of answers; triangle counts within the object.
inline AnswerHit answer_hit(const RayHit& hit, ObjectId object, std::uint32_t triangle, std::uint8_t flags) {
  return {.object = object,
          .triangle = triangle,
          .flags = static_cast<std::uint8_t>(flags | (hit.inside ? kHitInside : 0)),
          .distance_m = hit.distance_m,
          .error_m = hit.distance_error_m,
          .exit_m = hit.exit_m,
          .point = copied(hit.point),
          .point_error_m = point_error_m(hit),
          .normal = copied(hit.normal),
          .weights = copied(hit.weights)};
}

}  // namespace collided::engine
