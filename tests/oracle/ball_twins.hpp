#pragma once

#include <algorithm>
#include <cmath>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/nearest_value.hpp"

namespace collided::oracle {
using namespace engine;

/// The contact of two overlapping spheres by the nearest point of the second, as any point's is found, with all its bounds.
inline Contact plain_contact(const Sphere& a, const Sphere& b) {
  const kernel::NearestValue nearest = kernel::nearest_value(a.center, a.radius_m, b);
  const Vec3 towards = nearest.away.isZero(0) ? Vec3(-Vec3::UnitX()) : nearest.away;
  const double depth_m = std::max(-nearest.gap.value, 0.0);
  return {.point = nearest.foot + (b.radius_m - depth_m / 2) * towards,
          .normal = -towards,
          .depth_m = depth_m,
          .depth_error_m = nearest.gap.bound() + std::abs(depth_m + nearest.gap.value)};
}

}  // namespace collided::oracle
