#pragma once

#include <algorithm>
#include <limits>

#include "server/geometry/aabb.hpp"
#include "server/geometry/ray.hpp"

namespace collided::engine {

/// A lower bound on where along the ray the box begins, metres; infinite if the ray misses it. A ray that misses by a
/// rounding counts as meeting the box.
/// threads  pure
inline double entry_of(const Ray& ray, const Aabb& box) {
  double first = 0;
  double last = ray.length_m / ray.direction.norm();
  for (int axis = 0; axis < 3; ++axis) {
    const double from = box.low[axis] - ray.origin[axis];
    const double to = box.high[axis] - ray.origin[axis];
    if (ray.direction[axis] == 0) {
      if (from > 0 || to < 0) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double a = from / ray.direction[axis];
    const double b = to / ray.direction[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  constexpr double kSlack = 0x1p-40;
  return first <= last * (1 + kSlack) ? first * ray.direction.norm() * (1 - kSlack)
                                      : std::numeric_limits<double>::infinity();
}

}  // namespace collided::engine
