#pragma once

#include "server/exact_phase/arithmetic/ladder.hpp"
#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/nearest_value.hpp"
#include "server/exact_phase/kernels/overlap_kernel.hpp"

namespace collided::engine::kernel {

inline Closest inside_at(const Vec3& point, const Vec3& normal) { return {0, 0, point, normal, 0}; }

/// The foot plus the radius along the direction: sums the errors of both, of their product (1 u) and of their sum.
inline Closest outside_at(const NearestValue& nearest, double radius_m) {
  Closest result{nearest.gap.value, nearest.gap.bound(), nearest.foot + radius_m * nearest.away, nearest.away};
  result.point_error_m = nearest.foot_error_m;
  if (radius_m > 0) {
    const double turned = radius_m * (nearest.away_error + 2 * kRoundoff);
    result.point_error_m += (turned + kPointSum * result.point.cwiseAbs().maxCoeff()) * (1 + kBoundSlack) + kUnderflow;
  }
  return result;
}

/// The outward normal of the face nearest to a point inside. In plain double, since no decision depends on it.
Vec3 nearest_face_normal(const Vec3& point, const Box& box);

/// Whether the closed shape contains the point, decided by the ladder.
template <class Climb, class Shape>
bool holds(const Shape& shape, const Vec3& point) {
  return Climb::climb([&]<class N>() { return sets_meet<N>(Sphere{point, 0}, shape); }).yes();
}

/// closest() with a given ladder: WholeLadder for answers, RationalsAlone for audits.
template <class Climb>
Closest closest_by(const Vec3& point, const Sphere& sphere) {
  const NearestValue nearest = nearest_by<Climb>(point, 0, sphere);
  const Vec3 normal = nearest.away.isZero(0) ? Vec3(Vec3::UnitX()) : nearest.away;
  if (holds<Climb>(sphere, point) && sphere.radius_m > 0) return inside_at(point, normal);
  Closest result = outside_at(nearest, sphere.radius_m);
  result.normal = normal;
  return result;
}

template <class Climb>
Closest closest_by(const Vec3& point, const Box& box) {
  if (holds<Climb>(box, point)) return inside_at(point, nearest_face_normal(point, box));
  return outside_at(nearest_by<Climb>(point, 0, box), 0);
}

template <class Climb>
Closest closest_by(const Vec3& point, const Capsule& capsule) {
  const NearestValue nearest = nearest_by<Climb>(point, 0, capsule);
  const Vec3 normal = nearest.away.isZero(0) ? any_normal(Vec3(capsule.b - capsule.a)) : nearest.away;
  if (holds<Climb>(capsule, point)) return inside_at(point, normal);
  return outside_at(nearest, capsule.radius_m);
}

template <class Climb>
Closest closest_by(const Vec3& point, const Triangle& triangle) {
  const NearestValue nearest = nearest_by<Climb>(point, 0, triangle);
  Closest result = outside_at(nearest, 0);
  if (result.normal.isZero(0)) result.normal = any_normal(triangle);
  return result;
}

}  // namespace collided::engine::kernel
