#pragma once

#include <optional>

#include "server/geometry/vector.hpp"

namespace collided::engine {

/// The sign of (b - a) x (c - a) . (d - a): +1 if d is in front of the plane a b c, the side from which a, b, c turn
/// left; -1 behind it, 0 in it. Nothing if exact arithmetic in double runs out of room.
///
/// cost    about 5 ns; about a microsecond if the sign is uncertain
/// source  filter: running error as in kOrientationError; exact: Shewchuk, "Adaptive Precision Floating-Point
///         Arithmetic and Fast Robust Geometric Predicates", 1997
std::optional<int> orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The plane through three points, prepared for testing many others: side(d) is orientation(a, b, c, d).
class OrientedPlane {
 public:
  OrientedPlane(const Vec3& a, const Vec3& b, const Vec3& c);
  std::optional<int> side(const Vec3& d) const {
    const int quick = quick_side(d);
    return quick != 0 ? quick : exact_side(d);
  }
  /// +1 or -1 if double is certain, else 0.
  int quick_side(const Vec3& d) const {
    const Vec3 to = d - a_;
    const double height = normal_.dot(to);
    const double bound = spread_ * to.cwiseAbs().maxCoeff() + kLeastBound;
    return height > bound ? 1 : height < -bound ? -1 : 0;
  }

 private:
  /// Products that underflow lose less than this.
  static constexpr double kLeastBound = 0x1p-1000;

  std::optional<int> exact_side(const Vec3& d) const;

  Vec3 a_;
  Vec3 b_;
  Vec3 c_;
  Vec3 normal_;
  double spread_;  // error per largest coordinate of d - a
};

}  // namespace collided::engine
