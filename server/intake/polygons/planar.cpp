#include "server/intake/polygons/planar.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

/// A sum of doubles without rounding: parts whose digits do not overlap, smallest first.
struct ExactSum {
  std::array<double, 12> parts{};
  std::size_t part_count = 0;

  void add(double value) {
    for (std::size_t i = 0; i < part_count; ++i) {
      const double sum = parts[i] + value;
      const double rounded_part = sum - value;
      parts[i] = (value - (sum - rounded_part)) + (parts[i] - rounded_part);
      value = sum;
    }
    parts[part_count++] = value;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  int sign() const {
    for (std::size_t i = part_count; i-- > 0;) {
      if (parts[i] != 0) { return parts[i] > 0 ? 1 : (parts[i] < 0 ? -1 : 0); }
    }
    return 0;
  }
};

}  // namespace

int turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const double left = (a[0] - c[0]) * (b[1] - c[1]);
  const double right = (a[1] - c[1]) * (b[0] - c[0]);
  const double determinant = left - right;
  if (std::abs(determinant) > kTurnError * (std::abs(left) + std::abs(right)) + std::numeric_limits<double>::min()) {
    return determinant > 0 ? 1 : -1;
  }
  // The products of c with itself cancel, so six products of given coordinates make the whole determinant.
  ExactSum sum;
  sum.add_product(a[0], b[1]);
  sum.add_product(-a[0], c[1]);
  sum.add_product(-c[0], b[1]);
  sum.add_product(-a[1], b[0]);
  sum.add_product(a[1], c[0]);
  sum.add_product(c[1], b[0]);
  return sum.sign();
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
