#include "server/intake/polygons/planar.hpp"

#include <algorithm>

#include "server/geometry/expansion.hpp"

namespace collided::engine {

namespace filtered {

int exact_turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const auto exact = [](double from, double to) { return Expansion(to) - Expansion(from); };
  const Expansion turned = exact(c[0], a[0]) * exact(c[1], b[1]) - exact(c[1], a[1]) * exact(c[0], b[0]);
  const double leading = turned.lost() ? 0.0 : turned.leading();
  return leading > 0 ? 1 : (leading < 0 ? -1 : 0);
}

}  // namespace filtered

bool edges_cross(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (std::max(a[axis], b[axis]) < std::min(c[axis], d[axis]) ||
        std::max(c[axis], d[axis]) < std::min(a[axis], b[axis]))
      return false;
  }
  return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

}  // namespace collided::engine
