#pragma once

#include <cmath>
#include <limits>

#include "server/geometry/mesh.hpp"
#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::extreme {
using namespace engine;

inline double up(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }
inline double down(double x) { return std::nextafter(x, -std::numeric_limits<double>::infinity()); }

/// Every length times 2^power: no digit changes, so no decision may.
struct Scaling {
  int power;

  double operator()(double x) const { return std::ldexp(x, power); }
  Vec3 operator()(const Vec3& v) const { return {(*this)(v[0]), (*this)(v[1]), (*this)(v[2])}; }
  Sphere operator()(const Sphere& s) const { return {(*this)(s.center), (*this)(s.radius_m)}; }
  Box operator()(const Box& b) const { return {(*this)(b.center), b.axes, (*this)(b.half_m)}; }
  Capsule operator()(const Capsule& c) const { return {(*this)(c.a), (*this)(c.b), (*this)(c.radius_m)}; }
  Cylinder operator()(const Cylinder& c) const { return {(*this)(c.a), (*this)(c.b), (*this)(c.radius_m)}; }
  Cone operator()(const Cone& c) const { return {(*this)(c.apex), (*this)(c.base), (*this)(c.radius_m)}; }
  Ellipsoid operator()(const Ellipsoid& e) const { return {(*this)(e.center), e.axes, (*this)(e.half_m)}; }
  Hull operator()(const Hull& hull) const {
    TriangleMesh mesh = *hull.mesh;
    for (Vec3& vertex : mesh.vertices) vertex = (*this)(vertex);
    return {std::make_shared<const TriangleMesh>(std::move(mesh)), hull.rotation, (*this)(hull.position)};
  }
  HalfSpace operator()(const HalfSpace& h) const { return {(*this)(h.point), h.normal}; }
  Triangle operator()(const Triangle& t) const { return {(*this)(t.a), (*this)(t.b), (*this)(t.c)}; }
  Ray operator()(const Ray& r) const { return {(*this)(r.origin), (*this)(r.direction), (*this)(r.length_m)}; }
};

/// Every point moved; exact when all sums are representable.
struct Shift {
  Vec3 by;

  Vec3 operator()(const Vec3& v) const { return v + by; }
  Sphere operator()(const Sphere& s) const { return {s.center + by, s.radius_m}; }
  Box operator()(const Box& b) const { return {b.center + by, b.axes, b.half_m}; }
  Capsule operator()(const Capsule& c) const { return {c.a + by, c.b + by, c.radius_m}; }
  Triangle operator()(const Triangle& t) const { return {t.a + by, t.b + by, t.c + by}; }
  Ray operator()(const Ray& r) const { return {r.origin + by, r.direction, r.length_m}; }
};

/// Coordinates renamed (x, y, z) -> (y, z, x), and x mirrored: exact, and orientation changes.
struct Renaming {
  bool mirrored;

  Vec3 operator()(const Vec3& v) const { return {v[1], v[2], mirrored ? -v[0] : v[0]}; }
  Sphere operator()(const Sphere& s) const { return {(*this)(s.center), s.radius_m}; }
  Box operator()(const Box& b) const {
    Box box{(*this)(b.center), b.axes, b.half_m};
    for (int i = 0; i < 3; ++i) box.axes.col(i) = (*this)(Vec3(b.axes.col(i)));
    return box;
  }
  Capsule operator()(const Capsule& c) const { return {(*this)(c.a), (*this)(c.b), c.radius_m}; }
  Triangle operator()(const Triangle& t) const { return {(*this)(t.a), (*this)(t.b), (*this)(t.c)}; }
  Ray operator()(const Ray& r) const { return {(*this)(r.origin), (*this)(r.direction), r.length_m}; }
};

}  // namespace collided::extreme
