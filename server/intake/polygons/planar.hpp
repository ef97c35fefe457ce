#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "server/geometry/tolerance.hpp"

namespace collided::engine {

/// A point of a coordinate plane.
using PlanePoint = std::array<double, 2>;

namespace filtered {
/// Same as turn(), by expansions: for signs that doubles do not decide.
int exact_turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c);
}  // namespace filtered

/// Which way the path a, b, c turns: +1 to the left, -1 to the right, 0 not at all. Exact, except 0 if a product of two
/// coordinates leaves the range of double.
/// source    Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997
inline int turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const double left = (a[0] - c[0]) * (b[1] - c[1]);
  const double right = (a[1] - c[1]) * (b[0] - c[0]);
  const double determinant = left - right;
  if (std::abs(determinant) > kTurnError * (std::abs(left) + std::abs(right)) + std::numeric_limits<double>::min()) {
    return determinant > 0 ? 1 : -1;
  }
  return filtered::exact_turn(a, b, c);
}

/// Whether the segments ab and cd cross at a point that is an end of neither. As exact as turn.
bool edges_cross(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d);

}  // namespace collided::engine
