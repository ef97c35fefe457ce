#pragma once

#include <algorithm>
#include <array>

#include "server/geometry/shapes.hpp"

namespace collided::oracle {
using namespace engine;

/// Moeller's test of two triangles, the homework's method, over any kind of number: double as published, rationals for
/// its exact form. Signed distances smaller than epsilon (in units of normal times length, absolute, as published) count as 0.
/// Triangles without area have no plane, and get no right answer from it.
/// source  Moeller, "A Fast Triangle-Triangle Intersection Test", 1997
template <class Number>
class Moeller {
 public:
  using Point = std::array<Number, 3>;
  using Corners = std::array<Point, 3>;

  explicit Moeller(Number epsilon = Number(0)) : epsilon_(std::move(epsilon)) {}

  static Corners corners(const Triangle& t) {
    Corners all;
    const Vec3* from[3] = {&t.a, &t.b, &t.c};
    for (int corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis) all[corner][axis] = Number((*from[corner])[axis]);
    }
    return all;
  }

  bool operator()(const Corners& a, const Corners& b) const {
    const Point normal_b = normal(b);
    const Distances da = distances(a, normal_b, b[0]);
    if (one_side(da)) return false;
    const Point normal_a = normal(a);
    const Distances db = distances(b, normal_a, a[0]);
    if (one_side(db)) return false;
    if (is_zero(da[0]) && is_zero(da[1]) && is_zero(da[2])) return coplanar(a, b, normal_a);
    const int axis = largest_axis(cross(normal_a, normal_b));
    const Interval of_a = interval(a, da, axis);
    const Interval of_b = interval(b, db, axis);
    return !(of_a.high < of_b.low) && !(of_b.high < of_a.low);
  }

 private:
  using Distances = std::array<Number, 3>;
  struct Interval {
    Number low;
    Number high;
  };

  static bool is_zero(const Number& x) { return x == 0; }
  static Number magnitude(const Number& x) { return x < 0 ? Number(-x) : x; }
  static Point difference(const Point& p, const Point& q) {
    return {Number(p[0] - q[0]), Number(p[1] - q[1]), Number(p[2] - q[2])};
  }
  static Number dot(const Point& p, const Point& q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; }
  static Point cross(const Point& p, const Point& q) {
    return {Number(p[1] * q[2] - p[2] * q[1]), Number(p[2] * q[0] - p[0] * q[2]), Number(p[0] * q[1] - p[1] * q[0])};
  }
  static Point normal(const Corners& t) { return cross(difference(t[1], t[0]), difference(t[2], t[0])); }

  /// Of the corners from the plane through `on` with that normal, times the normal's length.
  Distances distances(const Corners& t, const Point& plane_normal, const Point& on) const {
    const Number offset = -dot(plane_normal, on);
    Distances d;
    for (int corner = 0; corner < 3; ++corner) {
      d[corner] = dot(plane_normal, t[corner]) + offset;
      if (magnitude(d[corner]) < epsilon_) d[corner] = 0;
    }
    return d;
  }
  static bool one_side(const Distances& d) {
    return (d[0] > 0 && d[1] > 0 && d[2] > 0) || (d[0] < 0 && d[1] < 0 && d[2] < 0);
  }
  static int largest_axis(const Point& v) {
    int axis = 0;
    for (int other = 1; other < 3; ++other) {
      if (magnitude(v[other]) > magnitude(v[axis])) axis = other;
    }
    return axis;
  }

  /// Where the triangle crosses the line in which the planes meet, measured along one axis.
  static Interval interval(const Corners& t, const Distances& d, int axis) {
    int alone = 0;  // the corner on a side of its own
    if (d[0] * d[1] > 0) {
      alone = 2;
    } else if (d[0] * d[2] > 0) {
      alone = 1;
    } else if (d[1] * d[2] > 0 || !is_zero(d[0])) {
      alone = 0;
    } else {
      alone = is_zero(d[1]) ? 2 : 1;
    }
    const auto crossing = [&](int other) {
      const Number& from = t[alone][axis];
      return Number(from + (t[other][axis] - from) * d[alone] / (d[alone] - d[other]));
    };
    const Number p = crossing((alone + 1) % 3);
    const Number q = crossing((alone + 2) % 3);
    return p < q ? Interval{p, q} : Interval{q, p};
  }

  /// Twice the signed area of a flat triangle.
  static Number turn(const Point& p, const Point& q, const Point& r, int u, int v) {
    return (q[u] - p[u]) * (r[v] - p[v]) - (q[v] - p[v]) * (r[u] - p[u]);
  }
  static bool within(const Point& p, const Point& q, const Point& r, int u, int v) {
    const auto between = [](const Number& x, const Number& from, const Number& to) {
      return !(x < std::min(from, to)) && !(x > std::max(from, to));
    };
    return between(r[u], p[u], q[u]) && between(r[v], p[v], q[v]);
  }
  static bool edges_meet(const Point& p, const Point& q, const Point& r, const Point& s, int u, int v) {
    const Number pr = turn(p, q, r, u, v), ps = turn(p, q, s, u, v), rp = turn(r, s, p, u, v), rq = turn(r, s, q, u, v);
    if (is_zero(pr) && within(p, q, r, u, v)) return true;
    if (is_zero(ps) && within(p, q, s, u, v)) return true;
    if (is_zero(rp) && within(r, s, p, u, v)) return true;
    if (is_zero(rq) && within(r, s, q, u, v)) return true;
    return (pr > 0) != (ps > 0) && (rp > 0) != (rq > 0) && !is_zero(pr) && !is_zero(ps) && !is_zero(rp) && !is_zero(rq);
  }
  static bool holds(const Corners& t, const Point& p, int u, int v) {
    const Number x = turn(t[0], t[1], p, u, v), y = turn(t[1], t[2], p, u, v), z = turn(t[2], t[0], p, u, v);
    return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
  }
  static bool coplanar(const Corners& a, const Corners& b, const Point& plane_normal) {
    const int dropped = largest_axis(plane_normal);
    const int u = (dropped + 1) % 3, v = (dropped + 2) % 3;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (edges_meet(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3], u, v)) return true;
      }
    }
    return holds(a, b[0], u, v) || holds(b, a[0], u, v);
  }

  Number epsilon_;
};

}  // namespace collided::oracle
