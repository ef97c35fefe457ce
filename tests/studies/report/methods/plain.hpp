#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::report {
using namespace engine;

// The textbook's tests in one number type, without a bound: what most programs run. In float and double they are the
// uncertified rows of the report; in a hundred digits some of them are its truth.

template <class T>
struct V {
  T x, y, z;
  V(T a, T b, T c) : x(a), y(b), z(c) {}
  explicit V(const Vec3& v) : x(static_cast<T>(v[0])), y(static_cast<T>(v[1])), z(static_cast<T>(v[2])) {}
  V operator-(const V& o) const { return {T(x - o.x), T(y - o.y), T(z - o.z)}; }
  V operator+(const V& o) const { return {T(x + o.x), T(y + o.y), T(z + o.z)}; }
  V operator*(const T& s) const { return {T(x * s), T(y * s), T(z * s)}; }
  T dot(const V& o) const { return T(x * o.x + y * o.y + z * o.z); }
  V cross(const V& o) const { return {T(y * o.z - z * o.y), T(z * o.x - x * o.z), T(x * o.y - y * o.x)}; }
};

/// The parameter at which a ray meets a triangle.
/// source  Moeller, Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997
template <class T>
std::optional<T> plain_ray(const V<T>& origin, const V<T>& direction, const V<T>& a, const V<T>& b, const V<T>& c) {
  const V<T> edge1 = b - a;
  const V<T> edge2 = c - a;
  const V<T> p = direction.cross(edge2);
  const T det = edge1.dot(p);
  if (det == 0) return std::nullopt;
  const V<T> from = origin - a;
  const T u = from.dot(p) / det;
  const V<T> q = from.cross(edge1);
  const T v = direction.dot(q) / det;
  const T s = edge2.dot(q) / det;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && s >= 0)) return std::nullopt;
  return s;
}

/// The point of a triangle nearest to p.
/// source  Ericson, "Real-Time Collision Detection", 2005, 5.1.5
template <class T>
V<T> plain_closest(const V<T>& p, const V<T>& a, const V<T>& b, const V<T>& c) {
  const V<T> ab = b - a;
  const V<T> ac = c - a;
  const V<T> ap = p - a;
  const T d1 = ab.dot(ap);
  const T d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const V<T> bp = p - b;
  const T d3 = ab.dot(bp);
  const T d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const T vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * T(d1 / (d1 - d3));
  const V<T> cp = p - c;
  const T d5 = ab.dot(cp);
  const T d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const T vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * T(d2 / (d2 - d6));
  const T va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (c - b) * T((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const T denominator = T(1) / (va + vb + vc);
  return a + ab * T(vb * denominator) + ac * T(vc * denominator);
}

template <class T>
T plain_distance(const V<T>& p, const Triangle& t) {
  using std::sqrt;
  const V<T> away = p - plain_closest(p, V<T>(t.a), V<T>(t.b), V<T>(t.c));
  return sqrt(away.dot(away));
}

/// A convex body as its corners, the directions of its edges and the normals of its faces.
template <class T>
struct Body {
  std::array<V<T>, 8> corner;
  int corner_count = 0;
  std::array<V<T>, 3> edge;
  std::array<V<T>, 3> normal;
  int normal_count = 0;

  explicit Body(const Box& box)
      : corner(filled<8>()),
        corner_count(8),
        edge{V<T>(Vec3(box.axes.col(0))), V<T>(Vec3(box.axes.col(1))), V<T>(Vec3(box.axes.col(2)))},
        normal{edge[1].cross(edge[2]), edge[2].cross(edge[0]), edge[0].cross(edge[1])},
        normal_count(3) {
    for (int i = 0; i < 8; ++i) {
      corner[i] = V<T>(box.center);
      for (int k = 0; k < 3; ++k)
        corner[i] = corner[i] + edge[k] * static_cast<T>(i >> k & 1 ? box.half_m[k] : -box.half_m[k]);
    }
  }
  explicit Body(const Triangle& t)
      : corner(filled<8>()),
        corner_count(3),
        edge{V<T>(t.b) - V<T>(t.a), V<T>(t.c) - V<T>(t.b), V<T>(t.a) - V<T>(t.c)},
        normal{edge[0].cross(edge[1]), edge[0], edge[0]},
        normal_count(1) {
    corner[0] = V<T>(t.a);
    corner[1] = V<T>(t.b);
    corner[2] = V<T>(t.c);
  }

 private:
  template <std::size_t N>
  static std::array<V<T>, N> filled() {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return std::array<V<T>, N>{(static_cast<void>(I), V<T>(T(0), T(0), T(0)))...};
    }
    (std::make_index_sequence<N>());
  }
};

/// Length of the shortest translation that parts two bodies, negative when a separating axis is found.
/// source  Gottschalk, Lin, Manocha, "OBBTree", 1996: the normals of the Minkowski difference are among the 15 axes
template <class T>
T plain_depth(const Body<T>& a, const Body<T>& b) {
  using std::sqrt;
  bool first = true;
  T least = 0;
  const auto look_along = [&](const V<T>& n, const T& factors2) {
    const T length2 = n.dot(n);
    // Edges as good as parallel give no direction.
    if (!(length2 > std::numeric_limits<T>::epsilon() * factors2)) return;
    const auto range = [&](const Body<T>& body) {
      T low = n.dot(body.corner[0]);
      T high = low;
      for (int i = 1; i < body.corner_count; ++i) {
        const T along = n.dot(body.corner[i]);
        if (along < low) low = along;
        if (along > high) high = along;
      }
      return std::array<T, 2>{low, high};
    };
    const auto ra = range(a);
    const auto rb = range(b);
    const T forward = ra[1] - rb[0];
    const T backward = rb[1] - ra[0];
    const T push = (forward < backward ? forward : backward) / sqrt(length2);
    if (first || push < least) least = push;
    first = false;
  };
  for (int i = 0; i < a.normal_count; ++i) look_along(a.normal[i], T(0));
  for (int i = 0; i < b.normal_count; ++i) look_along(b.normal[i], T(0));
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      look_along(a.edge[i].cross(b.edge[j]), a.edge[i].dot(a.edge[i]) * b.edge[j].dot(b.edge[j]));
  }
  return least;
}

/// Least root in [0, 1] of a t^2 + 2 b t + c, which is positive at 0.
template <class T>
std::optional<T> entering_root(const T& a, const T& b, const T& c) {
  using std::sqrt;
  const T discriminant = b * b - a * c;
  if (discriminant < 0 || a == 0) return std::nullopt;
  const T t = (-b - sqrt(discriminant)) / a;
  return t >= 0 && t <= 1 ? std::optional<T>(t) : std::nullopt;
}

/// First time in [0, 1] at which a moving sphere meets a triangle: its face, then its edges and corners.
/// source  Ericson, "Real-Time Collision Detection", 2005, 5.5
template <class T>
std::optional<T> plain_time(const V<T>& start, const V<T>& end, T radius, const Triangle& t) {
  using std::sqrt;
  if (plain_distance(start, t) <= radius) return T(0);
  const V<T> corner[3] = {V<T>(t.a), V<T>(t.b), V<T>(t.c)};
  const V<T> d = end - start;
  std::optional<T> best;
  const auto offer = [&](const std::optional<T>& time) {
    if (time && (!best || *time < *best)) best = time;
  };
  const V<T> n = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  const T length = sqrt(n.dot(n));
  const T height = n.dot(start - corner[0]) / length;
  const T speed = n.dot(d) / length;
  if (speed != 0) {
    const T time = ((height > 0 ? radius : -radius) - height) / speed;
    if (time >= 0 && time <= 1) {
      const V<T> foot = start + d * time;
      bool inside = true;
      for (int i = 0; i < 3; ++i)
        inside = inside && n.cross(corner[(i + 1) % 3] - corner[i]).dot(foot - corner[i]) >= 0;
      if (inside) offer(time);
    }
  }
  for (int i = 0; i < 3; ++i) {
    const V<T> w = start - corner[i];
    offer(entering_root<T>(d.dot(d), w.dot(d), w.dot(w) - radius * radius));
    const V<T> e = corner[(i + 1) % 3] - corner[i];
    const T ee = e.dot(e);
    const T a = ee * d.dot(d) - e.dot(d) * e.dot(d);
    const T b = ee * w.dot(d) - e.dot(w) * e.dot(d);
    const T c = ee * (w.dot(w) - radius * radius) - e.dot(w) * e.dot(w);
    const auto time = entering_root<T>(a, b, c);
    if (time) {
      const T along = e.dot(w) + *time * e.dot(d);
      if (along >= 0 && along <= ee) offer(time);
    }
  }
  return best;
}

}  // namespace collided::report
