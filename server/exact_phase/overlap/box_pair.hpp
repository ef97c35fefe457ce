#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "server/exact_phase/arithmetic/triple.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// A box's axes in plain double, with values derived for tests of separation.
struct BoxAxes {
  std::array<Triple, 3> axis;
  std::array<Triple, 3> normal;  // cross products of the other two axes
  double volume;
  double largest = 0;
  double half_sum;

  explicit BoxAxes(const Box& box) : half_sum(box.half_m.sum()) {
    for (int i = 0; i < 3; ++i) {
      axis[i] = {box.axes(0, i), box.axes(1, i), box.axes(2, i)};
      largest = std::max(largest, axis[i].largest());
    }
    for (int i = 0; i < 3; ++i) normal[i] = cross(axis[(i + 1) % 3], axis[(i + 2) % 3]);
    volume = std::abs(dot(axis[0], normal[0]));
  }
};

/// Two boxes along the 15 axes that can separate them, in plain double: products over cross axes reuse those over the
/// face normals, since a x b . c = b x c . a.
struct BoxPair {
  BoxAxes a;
  BoxAxes b;
  const Vec3& half_a;
  const Vec3& half_b;
  Triple between;         // from a's centre to b's
  double a_over_b[3][3];  // |axis i of a . normal j of b|
  double b_over_a[3][3];

  BoxPair(const Box& first, const Box& second)
      : a(first),
        b(second),
        half_a(first.half_m),
        half_b(second.half_m),
        between(triple(second.center) - triple(first.center)) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        a_over_b[i][j] = std::abs(dot(a.axis[i], b.normal[j]));
        b_over_a[i][j] = std::abs(dot(b.axis[i], a.normal[j]));
      }
    }
  }

  /// The largest coordinate of an axis, and an upper bound on that of a difference between two of their points.
  double axis() const { return std::max(a.largest, b.largest); }
  double reach() const { return between.largest() + axis() * (a.half_sum + b.half_sum); }

  /// Calls visit(number, n, extent) for the axes n, of any length, in the order of facet_axes(): a's faces, b's faces,
  /// crosses of edges. extent: how far both together reach along n from their centres, times |n|. visit returns false
  /// to end.
  template <class Visit>
  bool for_each_axis(Visit&& visit) const {
    for (int i = 0; i < 3; ++i) {
      const double own = half_a[i] * a.volume;
      if (!visit(i, a.normal[i], own + reach_over(half_b, b_over_a, i))) return false;
    }
    for (int i = 0; i < 3; ++i) {
      const double own = half_b[i] * b.volume;
      if (!visit(3 + i, b.normal[i], own + reach_over(half_a, a_over_b, i))) return false;
    }
    for (int i = 0; i < 3; ++i) {
      const int i1 = (i + 1) % 3;
      const int i2 = (i + 2) % 3;
      for (int j = 0; j < 3; ++j) {
        const int j1 = (j + 1) % 3;
        const int j2 = (j + 2) % 3;
        const double extent_a = half_a[i1] * b_over_a[j][i2] + half_a[i2] * b_over_a[j][i1];
        const double extent_b = half_b[j1] * a_over_b[i][j2] + half_b[j2] * a_over_b[i][j1];
        if (!visit(6 + 3 * i + j, cross(a.axis[i], b.axis[j]), extent_a + extent_b)) return false;
      }
    }
    return true;
  }

 private:
  static double reach_over(const Vec3& half, const double (&over)[3][3], int j) {
    return half[0] * over[0][j] + half[1] * over[1][j] + half[2] * over[2][j];
  }
};

}  // namespace collided::engine::kernel
