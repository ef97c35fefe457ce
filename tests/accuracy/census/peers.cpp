#include "tests/accuracy/census/peers.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace collided::census {
using namespace engine;
namespace {

template <class Real>
bool plain_ray(const Ray& ray, const Triangle& triangle) {
  using V = Eigen::Matrix<Real, 3, 1>;
  const V a = triangle.a.cast<Real>();
  const V edge1 = triangle.b.cast<Real>() - a;
  const V edge2 = triangle.c.cast<Real>() - a;
  const V direction = ray.direction.cast<Real>();
  const V p = direction.cross(edge2);
  const Real determinant = edge1.dot(p);
  if (determinant == 0) return false;
  const Real inverse = 1 / determinant;
  const V from = ray.origin.cast<Real>() - a;
  const Real u = from.dot(p) * inverse;
  if (u < 0 || u > 1) return false;
  const V q = from.cross(edge1);
  const Real v = direction.dot(q) * inverse;
  if (v < 0 || u + v > 1) return false;
  const Real t = edge2.dot(q) * inverse;
  return t >= 0 && t * direction.norm() <= static_cast<Real>(ray.length_m);
}

constexpr double kMoellerEpsilon = 1e-6;

using Distances = std::array<double, 3>;

Distances plane_distances(const Vec3& normal, double offset, const Triangle& t) {
  Distances d{normal.dot(t.a) + offset, normal.dot(t.b) + offset, normal.dot(t.c) + offset};
  for (double& x : d) x = std::abs(x) < kMoellerEpsilon ? 0 : x;
  return d;
}

bool edges_cross(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, int x, int y) {
  const double ax = q[x] - p[x], ay = q[y] - p[y];
  const double bx = r[x] - s[x], by = r[y] - s[y];
  const double cx = p[x] - r[x], cy = p[y] - r[y];
  const double f = ay * bx - ax * by;
  const double d = by * cx - bx * cy;
  if (!((f > 0 && d >= 0 && d <= f) || (f < 0 && d <= 0 && d >= f))) return false;
  const double e = ax * cy - ay * cx;
  return f > 0 ? e >= 0 && e <= f : e <= 0 && e >= f;
}

bool point_inside(const Vec3& p, const std::array<Vec3, 3>& t, int x, int y) {
  double side[3];
  for (int i = 0; i < 3; ++i) {
    const Vec3& u = t[i];
    const Vec3& v = t[(i + 1) % 3];
    side[i] = (v[y] - u[y]) * (p[x] - u[x]) - (v[x] - u[x]) * (p[y] - u[y]);
  }
  return side[0] * side[1] > 0 && side[0] * side[2] > 0;
}

bool coplanar_meet(const Vec3& normal, const Triangle& a, const Triangle& b) {
  int drop = 0;
  normal.cwiseAbs().maxCoeff(&drop);
  const int x = (drop + 1) % 3;
  const int y = (drop + 2) % 3;
  const std::array<Vec3, 3> f{a.a, a.b, a.c};
  const std::array<Vec3, 3> g{b.a, b.b, b.c};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (edges_cross(f[i], f[(i + 1) % 3], g[j], g[(j + 1) % 3], x, y)) return true;
    }
  }
  return point_inside(f[0], g, x, y) || point_inside(g[0], f, x, y);
}

/// Where the other plane cuts the triangle, along the common line; false if they are coplanar.
bool interval_on_line(const Distances& p, const Distances& d, std::array<double, 2>& interval) {
  int apex;
  if (d[0] * d[1] > 0) apex = 2;
  else if (d[0] * d[2] > 0) apex = 1;
  else if (d[1] * d[2] > 0 || d[0] != 0) apex = 0;
  else if (d[1] != 0) apex = 1;
  else if (d[2] != 0) apex = 2;
  else return false;
  const int u = (apex + 1) % 3;
  const int v = (apex + 2) % 3;
  interval = {p[apex] + (p[u] - p[apex]) * d[apex] / (d[apex] - d[u]),
              p[apex] + (p[v] - p[apex]) * d[apex] / (d[apex] - d[v])};
  if (interval[0] > interval[1]) std::swap(interval[0], interval[1]);
  return true;
}

}  // namespace

bool plain_float_ray(const Ray& ray, const Triangle& triangle) { return plain_ray<float>(ray, triangle); }
bool plain_double_ray(const Ray& ray, const Triangle& triangle) { return plain_ray<double>(ray, triangle); }

bool moeller_triangles(const Triangle& a, const Triangle& b) {
  const Vec3 normal_a = (a.b - a.a).cross(a.c - a.a);
  const Distances of_b = plane_distances(normal_a, -normal_a.dot(a.a), b);
  if (of_b[0] * of_b[1] > 0 && of_b[0] * of_b[2] > 0) return false;
  const Vec3 normal_b = (b.b - b.a).cross(b.c - b.a);
  const Distances of_a = plane_distances(normal_b, -normal_b.dot(b.a), a);
  if (of_a[0] * of_a[1] > 0 && of_a[0] * of_a[2] > 0) return false;
  int axis = 0;
  normal_a.cross(normal_b).cwiseAbs().maxCoeff(&axis);
  std::array<double, 2> on_a, on_b;
  if (!interval_on_line({a.a[axis], a.b[axis], a.c[axis]}, of_a, on_a) ||
      !interval_on_line({b.a[axis], b.b[axis], b.c[axis]}, of_b, on_b)) {
    return coplanar_meet(normal_a, a, b);
  }
  return !(on_a[1] < on_b[0] || on_b[1] < on_a[0]);
}

}  // namespace collided::census
