#include "server/exact_phase/distance/nearest_value.hpp"

#include <algorithm>

#include "server/exact_phase/arithmetic/ladder.hpp"

namespace collided::engine::kernel {

Pattern guessed_pattern(const Vec3& p, const Box& box) {
  const Vec3 w = p - box.center;
  Pattern at{};
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = box.axes.col(i);
    const double along = w.dot(axis);
    const double limit = box.half_m[i] * axis.squaredNorm();
    at[i] = along > limit ? 1 : along < -limit ? -1 : 0;
  }
  return at;
}

NearestValue nearest_value(const Vec3& point, double radius_m, const Sphere& sphere) {
  return nearest_by<WholeLadder>(point, radius_m, sphere);
}

NearestValue nearest_value(const Vec3& point, double radius_m, const Box& box) {
  return nearest_by<WholeLadder>(point, radius_m, box);
}

NearestValue nearest_value(const Vec3& point, double radius_m, const Capsule& capsule) {
  return nearest_by<WholeLadder>(point, radius_m, capsule);
}

NearestValue nearest_value(const Vec3& point, double radius_m, const Triangle& triangle) {
  return nearest_by<WholeLadder>(point, radius_m, triangle);
}

NearestValue nearest_value(const Vec3& point, const Sphere& sphere) { return nearest_value(point, 0, sphere); }
NearestValue nearest_value(const Vec3& point, const Box& box) { return nearest_value(point, 0, box); }
NearestValue nearest_value(const Vec3& point, const Capsule& capsule) { return nearest_value(point, 0, capsule); }
NearestValue nearest_value(const Vec3& point, const Triangle& triangle) { return nearest_value(point, 0, triangle); }

Vec3 any_normal(const Vec3& along) {
  const Vec3 direction = unit(along);
  if (direction.isZero(0)) return Vec3::UnitX();
  int smallest = 0;
  direction.cwiseAbs().minCoeff(&smallest);
  return unit(Vec3(direction.cross(Vec3::Unit(smallest))));
}

Vec3 any_normal(const Triangle& triangle) {
  const Vector<Bounded> quick = Facet<Bounded>(triangle).normal;
  const bool crisp = sharp_direction(quick) && is_zero(quick) != Decision::yes;
  const Vec3 normal = crisp ? unit(quick) : unit(Facet<Dyadic>(triangle).normal);
  if (!normal.isZero(0)) return normal;
  const Vec3 edges[3] = {triangle.b - triangle.a, triangle.c - triangle.b, triangle.a - triangle.c};
  return any_normal(*std::max_element(std::begin(edges), std::end(edges), [](const Vec3& a, const Vec3& b) {
    return a.cwiseAbs().maxCoeff() < b.cwiseAbs().maxCoeff();
  }));
}

}  // namespace collided::engine::kernel
