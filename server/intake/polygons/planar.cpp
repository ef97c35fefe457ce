#include "server/intake/polygons/planar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/geometry/expansion.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {

int turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const double left = (a[0] - c[0]) * (b[1] - c[1]);
  const double right = (a[1] - c[1]) * (b[0] - c[0]);
  const double determinant = left - right;
  if (std::abs(determinant) > kTurnError * (std::abs(left) + std::abs(right)) + std::numeric_limits<double>::min()) {
    return determinant > 0 ? 1 : -1;
  }
  const auto exact = [](double from, double to) { return Expansion(to) - Expansion(from); };
  const Expansion turned = exact(c[0], a[0]) * exact(c[1], b[1]) - exact(c[1], a[1]) * exact(c[0], b[0]);
  const double leading = turned.lost() ? 0.0 : turned.leading();
  return leading > 0 ? 1 : (leading < 0 ? -1 : 0);
}

bool edges_cross(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (std::max(a[axis], b[axis]) < std::min(c[axis], d[axis]) ||
        std::max(c[axis], d[axis]) < std::min(a[axis], b[axis]))
      return false;
  }
  return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

}  // namespace collided::engine
