#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/geometry/aabb.hpp"
#include "server/geometry/ray.hpp"
#include "server/geometry/vector.hpp"

namespace collided::engine {

/// Relative slack on computed parameters and squares: a few roundings of 2^-53 each.
inline constexpr double kRelative = 0x1p-49;
/// Absolute slack for results that underflow.
inline constexpr double kLeast = 16 * std::numeric_limits<double>::denorm_min();

/// The parameters at which a ray may be within [low, high]; empty if entry > exit. Zero components are decided by
/// comparison; an overflow leaves the axis unrestricted.
struct SlabSpan {
  double entry = 0;
  double exit = 0;
};

inline void clip(const Ray& ray, int axis, double low, double high, SlabSpan& span) {
  const double o = ray.origin[axis];
  const double d = ray.direction[axis];
  if (d == 0) {
    if (o < low || o > high) span.exit = -1;
    return;
  }
  // An infinite difference has no finite quotient.
  const double entry = ((d > 0 ? low : high) - o) / d;
  const double exit = ((d > 0 ? high : low) - o) / d;
  if (std::isfinite(entry)) span.entry = std::max(span.entry, entry - kRelative * std::abs(entry) - kLeast);
  if (std::isfinite(exit)) span.exit = std::min(span.exit, exit + kRelative * std::abs(exit) + kLeast);
}

/// The parameters for a whole box, within [0, limit]. Box: has low(axis) and high(axis).
template <class Box>
SlabSpan clip(const Ray& ray, const Box& box, double limit) {
  SlabSpan span{0, limit};
  for (int axis = 0; axis < 3 && span.entry <= span.exit; ++axis) clip(ray, axis, box.low(axis), box.high(axis), span);
  return span;
}

inline SlabSpan clip(const Ray& ray, const Aabb& box, double limit) {
  SlabSpan span{0, limit};
  for (int axis = 0; axis < 3 && span.entry <= span.exit; ++axis) clip(ray, axis, box.low[axis], box.high[axis], span);
  return span;
}

/// Whether the box may lie within the limit. A square may overflow only at a distance that no limit below 1e307
/// reaches.
template <class Box>
bool is_within(const Box& box, const Vec3& point, double limit_m2) {
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double away = std::max({box.low(axis) - point[axis], point[axis] - box.high(axis), 0.0});
    square += away * away;
  }
  return limit_m2 >= 1e307 || square * (1 - kRelative) <= limit_m2;
}

}  // namespace collided::engine
