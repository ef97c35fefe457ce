#pragma once

#include <cmath>
#include <initializer_list>
#include <limits>

#include "server/geometry/aabb.hpp"
#include "server/geometry/pose.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// Placing at coordinates of 2^20 m rounds by 1.2e-10 m. From there on subtracting a common origin first is cheaper
/// than the expansions and rationals that the rounding requires. Metres. It chooses the arithmetic and affects no
/// decision; nearer worlds keep their bits.
inline constexpr double kFarOut_m = 0x1p20;

/// True if one of the two is at most twice the other and they have the same sign: their difference is not rounded.
///
/// source  Sterbenz, "Floating-Point Computation", 1974, theorem 4.3.1
constexpr bool has_exact_difference(double x, double y) {
  return y > 0 ? y <= 2 * x && x <= 2 * y : y >= 2 * x && x >= 2 * y;
}

/// Common origins are multiples of this, metres. Coordinates relative to such an origin keep the same digits as near
/// the world's origin. Relative to its own middle a box would have sides that are parallel to the last digit, which
/// takes longer.
inline constexpr double kOriginGrid_m = 16;

/// An origin near all the points, from which they are seen without rounding: on each axis the coordinate of `point` to
/// the nearest kOriginGrid_m, or 0 if it is less than far_m from 0 or if some difference might be rounded.
///
/// far_m  metres, above 0
inline Vec3 common_origin(const Vec3& point, std::initializer_list<Vec3> others, double far_m = kFarOut_m) {
  Vec3 origin = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (!(std::abs(point[k]) >= far_m)) continue;
    const double near = kOriginGrid_m * std::round(point[k] / kOriginGrid_m);
    bool is_exact = has_exact_difference(point[k], near);
    for (const Vec3& other : others) is_exact = is_exact && has_exact_difference(other[k], near);
    if (is_exact) origin[k] = near;
  }
  return origin;
}

/// The value in coordinates relative to the origin: exact if all its points have exact differences from it.
inline Vec3 seen_from(const Vec3& origin, const Vec3& point) { return point - origin; }
inline Frame seen_from(const Vec3& origin, const Frame& frame) {
  return {.rotation = frame.rotation, .position = seen_from(origin, frame.position)};
}
inline Pose seen_from(const Vec3& origin, const Pose& pose) {
  return {.position = seen_from(origin, pose.position), .rotation = pose.rotation};
}
inline Triangle seen_from(const Vec3& origin, const Triangle& triangle) {
  return {seen_from(origin, triangle.a), seen_from(origin, triangle.b), seen_from(origin, triangle.c)};
}
/// Rounded outward, since the bounds of a near object need not be near. An empty box stays empty.
inline Aabb seen_from(const Vec3& origin, const Aabb& box) {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  Aabb seen = box;
  for (int k = 0; k < 3; ++k) {
    if (origin[k] == 0) continue;
    seen.low[k] = std::nextafter(box.low[k] - origin[k], -kEndless);
    seen.high[k] = std::nextafter(box.high[k] - origin[k], kEndless);
  }
  return seen;
}

/// Back to world coordinates. Rounds each coordinate once; with the origin 0 the point keeps its bits.
inline Vec3 back_from(const Vec3& origin, const Vec3& point) { return origin.isZero(0) ? point : Vec3(point + origin); }

}  // namespace collided::engine
