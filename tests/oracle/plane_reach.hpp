#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

#include "server/exact_phase/distance/convex.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"
#include "tests/oracle/exact_oracle.hpp"

namespace collided::oracle {
using namespace engine;

// A solid against a plane, in rationals, and places where the two nearly touch.

inline Rational dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Point plus(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Point times(const Rational& s, const Point& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Of p + sqrt(q).
inline int sign_with_root(const Rational& p, const Rational& q) {
  if (p >= 0) return p == 0 && q == 0 ? 0 : 1;
  const Rational rest = q - p * p;
  return rest > 0 ? 1 : rest < 0 ? -1 : 0;
}

/// The sign of how far the solid reaches along n past the value c.
inline int reaches_past(const Primitive& solid, const Point& n, const Rational& c) {
  const auto at = [&](const Vec3& p) -> Rational { return dot(n, exact(p)) - c; };
  const auto disc = [&](const Vec3& from, const Vec3& to, double radius_m) -> Rational {
    const Point axis = minus(exact(to), exact(from));
    const Point turn = cross(n, axis);
    return Rational(radius_m) * Rational(radius_m) * dot(turn, turn) / dot(axis, axis);
  };
  if (const auto* s = std::get_if<Sphere>(&solid))
    return sign_with_root(at(s->center), Rational(s->radius_m) * Rational(s->radius_m) * dot(n, n));
  if (const auto* s = std::get_if<Capsule>(&solid)) {
    return sign_with_root(std::max(at(s->a), at(s->b)), Rational(s->radius_m) * Rational(s->radius_m) * dot(n, n));
  }
  if (const auto* s = std::get_if<Cylinder>(&solid))
    return sign_with_root(std::max(at(s->a), at(s->b)), disc(s->a, s->b, s->radius_m));
  if (const auto* s = std::get_if<Cone>(&solid)) {
    return std::max(sign_with_root(at(s->apex), 0), sign_with_root(at(s->base), disc(s->apex, s->base, s->radius_m)));
  }
  if (const auto* s = std::get_if<Box>(&solid)) {
    Rational most = at(s->center);
    for (int i = 0; i < 3; ++i) most += Rational(s->half_m[i]) * abs(dot(n, exact(s->axes.col(i))));
    return sign_with_root(most, 0);
  }
  if (const auto* s = std::get_if<Hull>(&solid)) {
    int most = -1;
    for (std::size_t i = 0; i < s->mesh->vertices.size(); ++i)
      most = std::max(most, sign_with_root(at(vertex_of(*s, i)), 0));
    return most;
  }
  const auto& e = std::get<Ellipsoid>(solid);
  Rational sum = 0;
  for (int i = 0; i < 3; ++i) {
    const Rational along = Rational(e.half_m[i]) * dot(n, exact(e.axes.col(i)));
    sum += along * along;
  }
  return sign_with_root(at(e.center), sum);
}

inline kernel::Convex convex_of(const Primitive& solid) {
  return std::visit(
      [](const auto& shape) {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, HalfSpace>)
          return kernel::Convex(Sphere{shape.point, 0});
        else return kernel::Convex(shape);
      },
      solid);
}

/// About the solid's lowest point against n, where things are to touch.
inline Vec3 lowest(const Primitive& solid, const Vec3& n) {
  const kernel::Convex set = convex_of(solid);
  return set.carrier[0] + set.support(-n) - set.ball_m * n.normalized();
}

/// Two directions across n and each other, lattice-like where n is.
inline std::pair<Vec3, Vec3> across(const Vec3& n) {
  int least = 0;
  n.cwiseAbs().minCoeff(&least);
  const Vec3 u = n.cross(Vec3::Unit(least)).normalized();
  return {u, n.cross(u)};
}

/// One rounding up or down in every coordinate that counts.
inline double stepped(double x, int ulps) {
  if (ulps == 0) return x;
  return std::nextafter(x, ulps > 0 ? 1e300 : -1e300);
}
inline Vec3 stepped(Vec3 p, const Vec3& n, int ulps) {
  int most = 0;
  n.cwiseAbs().maxCoeff(&most);
  p[most] = stepped(p[most], n[most] > 0 ? ulps : -ulps);
  return p;
}

/// Of four points, whose faces need no building.
inline Primitive tetrahedron(const Triangle& face, const Vec3& n, const Vec3& apex) {
  TriangleMesh mesh{.vertices = {face.a, face.b, face.c, apex},
                    .triangles = {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}}};
  if ((face.b - face.a).cross(face.c - face.a).dot(n) < 0) {
    for (TriangleCorners& corner : mesh.triangles) std::swap(corner[0], corner[1]);
  }
  return Hull{std::make_shared<const TriangleMesh>(std::move(mesh))};
}

}  // namespace collided::oracle
