#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "tests/accuracy/census/wide_int.hpp"

namespace collided::census {

// The truth about shapes on a grid of whole numbers, in whole numbers: nothing is rounded, nothing is filtered, and
// the formulations are not the product's. T is any whole number type wide enough (degree 8 in the coordinates for
// lengths and distances, 4 for triangles alone).

using GridPoint = std::array<std::int64_t, 3>;

template <class T>
struct Vec {
  T x, y, z;

  Vec() = default;
  Vec(T x_in, T y_in, T z_in) : x(x_in), y(y_in), z(z_in) {}
  Vec(const GridPoint& p) : x(p[0]), y(p[1]), z(p[2]) {}  // NOLINT
  bool zero() const { return x == T(0) && y == T(0) && z == T(0); }
};
template <class T>
Vec<T> operator*(const T& s, const Vec<T>& v) {
  return {s * v.x, s * v.y, s * v.z};
}
template <class T>
Vec<T> operator-(const Vec<T>& a, const Vec<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vec<T> operator+(const Vec<T>& a, const Vec<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
T dot(const Vec<T>& a, const Vec<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vec<T> cross(const Vec<T>& a, const Vec<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T square(const Vec<T>& a) {
  return dot(a, a);
}

/// numerator / denominator, the denominator positive.
template <class T>
struct Fraction {
  T numerator;
  T denominator;
};

template <class T>
bool at_most(const Fraction<T>& a, const T& b) {
  return a.numerator <= b * a.denominator;
}

/// Where a line o + s d is looked at: 0 <= s, and s <= 1 or s |d| <= length, or without end.
template <class T>
struct LineEnd {
  enum Kind { none, at_one, at_length } kind = none;
  T length = T(0);

  bool reaches(const Fraction<T>& s, const Vec<T>& d) const {
    if (kind == none) return true;
    if (kind == at_one) return s.numerator <= s.denominator;
    return s.numerator * s.numerator * square(d) <= length * length * s.denominator * s.denominator;
  }
};

template <class T>
using Corners = std::array<Vec<T>, 3>;

/// The first parameter at which the line meets the segment p q (possibly a point). d is not zero.
template <class T>
bool meets_segment(const Vec<T>& o, const Vec<T>& d, const Vec<T>& p, const Vec<T>& q, Fraction<T>& s) {
  const Vec<T> e = q - p;
  const Vec<T> w = p - o;
  const Vec<T> k = cross(d, e);
  if (k.zero()) {
    if (!cross(w, d).zero() || !cross(q - o, d).zero()) return false;
    const T a = dot(w, d);
    const T b = dot(q - o, d);
    if (a < T(0) && b < T(0)) return false;
    const T nearer = a < b ? a : b;
    s = {nearer < T(0) ? T(0) : nearer, square(d)};
    return true;
  }
  if (dot(w, k) != T(0)) return false;
  const T kk = square(k);
  const T along = dot(cross(w, d), k);
  s = {dot(cross(w, e), k), kk};
  return s.numerator >= T(0) && along >= T(0) && along <= kk;
}

/// The line lies in the triangle's plane: cut it by the three edges, in the two coordinates that keep the area.
template <class T>
bool meets_in_plane(const Vec<T>& o, const Vec<T>& d, const Corners<T>& t, const Vec<T>& n, Fraction<T>& low) {
  const int drop = n.z != T(0) ? 2 : n.y != T(0) ? 1 : 0;
  const auto flat = [drop](const Vec<T>& v) {
    return drop == 2 ? std::pair{v.x, v.y} : drop == 1 ? std::pair{v.z, v.x} : std::pair{v.y, v.z};
  };
  const T area = drop == 2 ? n.z : drop == 1 ? n.y : n.x;
  low = {T(0), T(1)};
  Fraction<T> high{T(1), T(0)};
  for (int i = 0; i < 3; ++i) {
    const auto [ex, ey] = flat(t[(i + 1) % 3] - t[i]);
    const auto [wx, wy] = flat(o - t[i]);
    const auto [dx, dy] = flat(d);
    T inside = ex * wy - ey * wx;
    T slope = ex * dy - ey * dx;
    if (area < T(0)) inside = -inside, slope = -slope;
    if (slope == T(0)) {
      if (inside < T(0)) return false;
    } else if (slope > T(0)) {
      if (-inside * low.denominator > low.numerator * slope) low = {-inside, slope};
    } else if (inside * high.denominator < high.numerator * -slope) {
      high = {inside, -slope};
    }
  }
  return low.numerator * high.denominator <= high.numerator * low.denominator;
}

/// Moeller and Trumbore's test without rounding, and the flat cases it leaves out. d is not zero.
template <class T>
bool first_on_triangle(const Vec<T>& o, const Vec<T>& d, const Corners<T>& t, Fraction<T>& s) {
  const Vec<T> e1 = t[1] - t[0];
  const Vec<T> e2 = t[2] - t[0];
  const Vec<T> n = cross(e1, e2);
  if (n.zero()) {
    bool found = false;
    for (int i = 0; i < 3; ++i) {
      Fraction<T> next;
      if (!meets_segment(o, d, t[i], t[(i + 1) % 3], next)) continue;
      if (!found || next.numerator * s.denominator < s.numerator * next.denominator) s = next;
      found = true;
    }
    return found;
  }
  const Vec<T> w = o - t[0];
  const Vec<T> p = cross(d, e2);
  T determinant = dot(e1, p);
  if (determinant == T(0)) return dot(w, n) == T(0) && meets_in_plane(o, d, t, n, s);
  const Vec<T> q = cross(w, e1);
  T u = dot(w, p);
  T v = dot(d, q);
  T along = dot(e2, q);
  if (determinant < T(0)) determinant = -determinant, u = -u, v = -v, along = -along;
  s = {along, determinant};
  return u >= T(0) && v >= T(0) && u + v <= determinant && along >= T(0);
}

template <class T>
bool line_meets_triangle(const Vec<T>& o, const Vec<T>& d, const LineEnd<T>& end, const Corners<T>& t) {
  Fraction<T> s;
  return first_on_triangle(o, d, t, s) && end.reaches(s, d);
}

template <class T>
Fraction<T> squared_distance(const Vec<T>& p, const Vec<T>& a, const Vec<T>& b) {
  const Vec<T> e = b - a;
  const Vec<T> w = p - a;
  const T along = dot(w, e);
  const T ee = square(e);
  if (along <= T(0)) return {square(w), T(1)};
  if (along >= ee) return {square(p - b), T(1)};
  return {square(cross(w, e)), ee};
}

template <class T>
const Fraction<T>& lesser(const Fraction<T>& a, const Fraction<T>& b) {
  return a.numerator * b.denominator < b.numerator * a.denominator ? a : b;
}

/// By the region of the triangle's plane above which the point stands (Ericson, "Real-Time Collision Detection",
/// 5.1.5), without rounding.
template <class T>
Fraction<T> squared_distance(const Vec<T>& p, const Corners<T>& t) {
  const Vec<T> ab = t[1] - t[0];
  const Vec<T> ac = t[2] - t[0];
  const Vec<T> n = cross(ab, ac);
  if (n.zero()) {
    const Fraction<T> first = lesser(squared_distance(p, t[0], t[1]), squared_distance(p, t[1], t[2]));
    return lesser(first, squared_distance(p, t[2], t[0]));
  }
  const Vec<T> ap = p - t[0];
  const T d1 = dot(ab, ap);
  const T d2 = dot(ac, ap);
  if (d1 <= T(0) && d2 <= T(0)) return {square(ap), T(1)};
  const Vec<T> bp = p - t[1];
  const T d3 = dot(ab, bp);
  const T d4 = dot(ac, bp);
  if (d3 >= T(0) && d4 <= d3) return {square(bp), T(1)};
  if (d1 * d4 - d3 * d2 <= T(0) && d1 >= T(0) && d3 <= T(0)) return {square(cross(ap, ab)), square(ab)};
  const Vec<T> cp = p - t[2];
  const T d5 = dot(ab, cp);
  const T d6 = dot(ac, cp);
  if (d6 >= T(0) && d5 <= d6) return {square(cp), T(1)};
  if (d5 * d2 - d1 * d6 <= T(0) && d2 >= T(0) && d6 <= T(0)) return {square(cross(ap, ac)), square(ac)};
  if (d3 * d6 - d5 * d4 <= T(0) && d4 >= d3 && d5 >= d6) {
    return {square(cross(bp, t[2] - t[1])), square(t[2] - t[1])};
  }
  const T height = dot(ap, n);
  return {height * height, square(n)};
}

/// Two segments, each possibly a point: their lines' nearest points if both are inner ones, else an end of one.
template <class T>
Fraction<T> squared_distance(const Vec<T>& a, const Vec<T>& b, const Vec<T>& c, const Vec<T>& d) {
  Fraction<T> best = lesser(squared_distance(a, c, d), squared_distance(b, c, d));
  best = lesser(best, lesser(squared_distance(c, a, b), squared_distance(d, a, b)));
  const Vec<T> u = b - a;
  const Vec<T> v = d - c;
  const Vec<T> w = a - c;
  const T uu = square(u);
  const T vv = square(v);
  const T uv = dot(u, v);
  const T determinant = uu * vv - uv * uv;
  if (determinant == T(0)) return best;
  const T s = uv * dot(v, w) - vv * dot(u, w);
  const T t = uu * dot(v, w) - uv * dot(u, w);
  if (s < T(0) || s > determinant || t < T(0) || t > determinant) return best;
  const T height = dot(w, cross(u, v));
  return {height * height, determinant};
}

/// For the segments of a ray without end: the same with d in place of an end.
template <class T>
Fraction<T> squared_distance_to_ray(const Vec<T>& o, const Vec<T>& d, const Vec<T>& a, const Vec<T>& b) {
  const auto from_ray = [&](const Vec<T>& p) -> Fraction<T> {
    const Vec<T> w = p - o;
    if (dot(w, d) <= T(0)) return {square(w), T(1)};
    return {square(cross(w, d)), square(d)};
  };
  const Fraction<T> best = lesser(lesser(from_ray(a), from_ray(b)), squared_distance(o, a, b));
  const Vec<T> v = b - a;
  const Vec<T> w = o - a;
  const T uu = square(d);
  const T vv = square(v);
  const T uv = dot(d, v);
  const T determinant = uu * vv - uv * uv;
  if (determinant == T(0)) return best;
  const T s = uv * dot(v, w) - vv * dot(d, w);
  const T t = uu * dot(v, w) - uv * dot(d, w);
  if (s < T(0) || t < T(0) || t > determinant) return best;
  const T height = dot(w, cross(d, v));
  return {height * height, determinant};
}

/// Some plane across the axis has the two triangles strictly on different sides.
template <class T>
bool separates(const Vec<T>& axis, const Corners<T>& f, const Corners<T>& g) {
  T f_low = T(0), f_high = T(0);
  for (int i = 1; i < 3; ++i) {
    const T along = dot(axis, f[i] - f[0]);
    if (along < f_low) f_low = along;
    if (along > f_high) f_high = along;
  }
  T g_low = dot(axis, g[0] - f[0]);
  T g_high = g_low;
  for (int i = 1; i < 3; ++i) {
    const T along = dot(axis, g[i] - f[0]);
    if (along < g_low) g_low = along;
    if (along > g_high) g_high = along;
  }
  return g_low > f_high || f_low > g_high;
}

/// By separating axes, which are complete whatever the two have shrunk to: every cross product of two edges, edges
/// across the plane when all lie in one, and across the line when all lie on one.
template <class T>
bool triangles_meet(const Corners<T>& f, const Corners<T>& g) {
  std::array<Vec<T>, 6> edge;
  for (int i = 0; i < 3; ++i) {
    edge[i] = f[(i + 1) % 3] - f[i];
    edge[i + 3] = g[(i + 1) % 3] - g[i];
  }
  const Vec<T> between = g[0] - f[0];
  if (separates(between, f, g)) return false;
  Vec<T> plane{T(0), T(0), T(0)};
  for (int i = 0; i < 6; ++i) {
    for (int j = i + 1; j < 6; ++j) {
      const Vec<T> n = cross(edge[i], edge[j]);
      if (n.zero()) continue;
      plane = n;
      if (separates(n, f, g)) return false;
    }
  }
  for (const Vec<T>& e : edge) {
    if (separates(e, f, g) || separates(cross(plane, e), f, g) || separates(cross(e, cross(e, between)), f, g)) {
      return false;
    }
  }
  return true;
}

/// The solid {center + sum u_i reach_i : |u_i| <= 1}; its surface as twelve triangles.
template <class T>
struct GridBox {
  Vec<T> center;
  std::array<Vec<T>, 3> reach;

  bool holds(const Vec<T>& p) const {
    const T volume = dot(reach[0], cross(reach[1], reach[2]));
    if (volume == T(0)) return false;  // its faces are all there is
    const T limit = volume < T(0) ? -volume : volume;
    for (int i = 0; i < 3; ++i) {
      const T along = dot(p - center, cross(reach[(i + 1) % 3], reach[(i + 2) % 3]));
      if (along > limit || -along > limit) return false;
    }
    return true;
  }

  Corners<T> face(int which) const {
    const int i = which % 3;
    const Vec<T>& u = reach[(i + 1) % 3];
    const Vec<T>& v = reach[(i + 2) % 3];
    const Vec<T> middle = which / 3 % 2 ? center + reach[i] : center - reach[i];
    if (which >= 6) return {middle + u + v, middle - u + v, middle - u - v};
    return {middle + u + v, middle + u - v, middle - u - v};
  }
};

template <class T>
bool box_within(const Vec<T>& p, const GridBox<T>& box, const T& reach2) {
  if (box.holds(p)) return true;
  for (int i = 0; i < 12; ++i) {
    if (at_most(squared_distance(p, box.face(i)), reach2)) return true;
  }
  return false;
}

template <class T>
bool triangle_within(const Vec<T>& a, const Vec<T>& b, const Corners<T>& t, const T& reach2) {
  if (at_most(squared_distance(a, t), reach2) || at_most(squared_distance(b, t), reach2)) return true;
  for (int i = 0; i < 3; ++i) {
    if (at_most(squared_distance(a, b, t[i], t[(i + 1) % 3]), reach2)) return true;
  }
  const Vec<T> d = b - a;
  return !d.zero() && line_meets_triangle(a, d, LineEnd<T>{LineEnd<T>::at_one, T(0)}, t);
}

template <class T>
bool box_within(const Vec<T>& a, const Vec<T>& b, const GridBox<T>& box, const T& reach2) {
  if (box.holds(a) || box.holds(b)) return true;
  for (int i = 0; i < 12; ++i) {
    if (triangle_within(a, b, box.face(i), reach2)) return true;
  }
  return false;
}

template <class T>
bool box_meets(const GridBox<T>& box, const Corners<T>& t) {
  for (const Vec<T>& corner : t) {
    if (box.holds(corner)) return true;
  }
  for (int i = 0; i < 12; ++i) {
    if (triangles_meet(box.face(i), t)) return true;
  }
  return false;
}

/// Separating axes (Gottschalk, Lin, Manocha, 1996) over the boxes' own axes, which span space also when sizes vanish.
template <class T>
bool boxes_meet(const GridBox<T>& a, const std::array<Vec<T>, 3>& axes_a, const GridBox<T>& b,
                const std::array<Vec<T>, 3>& axes_b) {
  const Vec<T> between = b.center - a.center;
  const auto keeps_apart = [&](const Vec<T>& n) {
    T gap = dot(n, between);
    if (gap < T(0)) gap = -gap;
    for (const GridBox<T>* box : {&a, &b}) {
      for (const Vec<T>& reach : box->reach) {
        const T along = dot(n, reach);
        gap = along < T(0) ? gap + along : gap - along;
      }
    }
    return gap > T(0);
  };
  for (int i = 0; i < 3; ++i) {
    if (keeps_apart(cross(axes_a[(i + 1) % 3], axes_a[(i + 2) % 3]))) return false;
    if (keeps_apart(cross(axes_b[(i + 1) % 3], axes_b[(i + 2) % 3]))) return false;
    for (int j = 0; j < 3; ++j) {
      if (keeps_apart(cross(axes_a[i], axes_b[j]))) return false;
    }
  }
  return true;
}

template <class T>
bool line_meets_box(const Vec<T>& o, const Vec<T>& d, const LineEnd<T>& end, const GridBox<T>& box) {
  if (box.holds(o)) return true;
  for (int i = 0; i < 12; ++i) {
    if (line_meets_triangle(o, d, end, box.face(i))) return true;
  }
  return false;
}

/// By the roots of the quadratic: from outside the first one is there, ahead, and within the length.
template <class T>
bool line_meets_ball(const Vec<T>& o, const Vec<T>& d, const LineEnd<T>& end, const Vec<T>& center, const T& radius) {
  const Vec<T> m = o - center;
  const T c = square(m) - radius * radius;
  if (c <= T(0)) return true;
  const T dd = square(d);
  const T b = dot(m, d);
  const T discriminant = b * b - dd * c;
  if (b >= T(0) || discriminant < T(0)) return false;
  if (end.kind == LineEnd<T>::none) return true;
  // -b - sqrt(D) <= L sqrt(dd), squared twice.
  const T past = dd * (c - end.length * end.length);
  return past <= T(0) || past * past <= T(4) * end.length * end.length * discriminant * dd;
}

}  // namespace collided::census
