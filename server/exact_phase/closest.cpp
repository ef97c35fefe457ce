#include "server/exact_phase/closest.hpp"

#include <variant>

#include "server/exact_phase/nearest_value.hpp"
#include "server/exact_phase/overlap.hpp"

namespace collided {
namespace {

Closest inside_at(const Vec3& point, const Vec3& normal) { return {0, 0, point, normal}; }

Closest outside_at(const kernel::NearestValue& nearest, double radius_m) {
  return {nearest.gap.value, nearest.gap.bound(), nearest.foot + radius_m * nearest.away, nearest.away};
}

/// The outward normal of the face that the inner point is nearest to.
Vec3 nearest_face_normal(const Vec3& point, const Box& box) {
  Vec3 best = Vec3::UnitX();
  double best_depth = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    Vec3 normal = kernel::unit(Vec3(kernel::unit(Vec3(box.axes.col((i + 1) % 3))).cross(kernel::unit(Vec3(box.axes.col((i + 2) % 3))))));
    const double along = normal.dot(point - box.center);
    if (along < 0) normal = -normal;
    const double depth = box.half_m[i] * std::abs(normal.dot(box.axes.col(i))) - std::abs(along);
    if (depth >= best_depth) continue;
    best_depth = depth;
    best = normal;
  }
  return best;
}

}  // namespace

Closest closest(const Vec3& point, const Sphere& sphere) {
  const kernel::NearestValue nearest = kernel::nearest_value(point, sphere);
  const Vec3 normal = nearest.away.isZero(0) ? Vec3(Vec3::UnitX()) : nearest.away;
  if (overlaps(Sphere{point, 0}, sphere).yes() && sphere.radius_m > 0) return inside_at(point, normal);
  Closest result = outside_at(nearest, sphere.radius_m);
  result.normal = normal;
  return result;
}

Closest closest(const Vec3& point, const Box& box) {
  if (overlaps(Sphere{point, 0}, box).yes()) return inside_at(point, nearest_face_normal(point, box));
  return outside_at(kernel::nearest_value(point, box), 0);
}

Closest closest(const Vec3& point, const Capsule& capsule) {
  const kernel::NearestValue nearest = kernel::nearest_value(point, capsule);
  const Vec3 normal =
      nearest.away.isZero(0) ? kernel::any_normal(Vec3(capsule.b - capsule.a)) : nearest.away;
  if (overlaps(Sphere{point, 0}, capsule).yes()) return inside_at(point, normal);
  return outside_at(nearest, capsule.radius_m);
}

Closest closest(const Vec3& point, const Triangle& triangle) {
  const kernel::NearestValue nearest = kernel::nearest_value(point, triangle);
  Closest result = outside_at(nearest, 0);
  if (result.normal.isZero(0)) result.normal = kernel::any_normal(triangle);
  return result;
}

Closest closest(const Vec3& point, const Primitive& primitive) {
  return std::visit([&](const auto& shape) { return closest(point, shape); }, primitive);
}

}  // namespace collided
