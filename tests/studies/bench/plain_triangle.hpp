#pragma once

#include <algorithm>
#include <cmath>

namespace collided::bench {

// What a user of a library without such tests writes: triangle tests in the library's own precision.

template <class T>
struct Three {
  T x, y, z;
  Three operator-(const Three& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Three operator+(const Three& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Three operator*(T s) const { return {x * s, y * s, z * s}; }
  T dot(const Three& o) const { return x * o.x + y * o.y + z * o.z; }
  Three cross(const Three& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
};

/// Square of the distance from p to the triangle. Source: Ericson, "Real-Time Collision Detection", 5.1.5.
template <class T>
T squared_distance(const Three<T>& p, const Three<T>& a, const Three<T>& b, const Three<T>& c) {
  const Three<T> ab = b - a;
  const Three<T> ac = c - a;
  const auto square_to = [&](const Three<T>& q) { return (p - q).dot(p - q); };
  const Three<T> ap = p - a;
  const T d1 = ab.dot(ap);
  const T d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return square_to(a);
  const Three<T> bp = p - b;
  const T d3 = ab.dot(bp);
  const T d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return square_to(b);
  const T vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return square_to(a + ab * (d1 / (d1 - d3)));
  const Three<T> cp = p - c;
  const T d5 = ab.dot(cp);
  const T d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return square_to(c);
  const T vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return square_to(a + ac * (d2 / (d2 - d6)));
  const T va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return square_to(b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  }
  const T scale = 1 / (va + vb + vc);
  return square_to(a + ab * (vb * scale) + ac * (vc * scale));
}

/// Box along the axes against a triangle. Source: Akenine-Moeller, "Fast 3D Triangle-Box Overlap Testing", 2001.
template <class T>
bool box_meets(const Three<T>& center, const Three<T>& half, const Three<T>& a, const Three<T>& b, const Three<T>& c) {
  const Three<T> v[3] = {a - center, b - center, c - center};
  const auto apart = [](T p, T q, T r, T reach) { return std::min({p, q, r}) > reach || std::max({p, q, r}) < -reach; };
  if (apart(v[0].x, v[1].x, v[2].x, half.x) || apart(v[0].y, v[1].y, v[2].y, half.y) ||
      apart(v[0].z, v[1].z, v[2].z, half.z)) {
    return false;
  }
  const Three<T> edge[3] = {v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  const auto parts = [&](const Three<T>& axis) {
    const T reach = half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
    return apart(axis.dot(v[0]), axis.dot(v[1]), axis.dot(v[2]), reach);
  };
  for (const Three<T>& e : edge) {
    if (parts({0, -e.z, e.y}) || parts({e.z, 0, -e.x}) || parts({-e.y, e.x, 0})) return false;
  }
  return !parts(edge[0].cross(edge[1]));
}

}  // namespace collided::bench
