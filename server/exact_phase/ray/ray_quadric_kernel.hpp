#pragma once

#include "server/exact_phase/kernels/membership_kernel.hpp"
#include "server/exact_phase/kernels/ray_kernel.hpp"
#include "server/exact_phase/ray/ray_round_kernel.hpp"

namespace collided::engine::kernel {

/// Where a ray is inside a solid bounded by one quadric and up to two planes: a s^2 + 2 b s + c <= 0 (a may be
/// negative: a cone seen along its inside) and offset + slope s >= 0 for each plane, with s in units of the direction.
template <class N>
struct QuadricAlong {
  Quadratic<N> wall;
  struct Plane {
    N offset;
    N slope;
  } plane[2];
  int planes = 0;
};

template <class N>
QuadricAlong<N> quadric_along(const Ray& ray, const Cylinder& cylinder) {
  QuadricAlong<N> q{cylinder_along<N>(ray, Capsule{cylinder.a, cylinder.b, cylinder.radius_m}), {}, 2};
  const Vector<N> axis = Vector<N>(cylinder.b) - Vector<N>(cylinder.a);
  const N start = dot(Vector<N>(ray.origin) - Vector<N>(cylinder.a), axis);
  const N speed = dot(Vector<N>(ray.direction), axis);
  q.plane[0] = {start, speed};
  q.plane[1] = {square(axis) - start, -speed};
  return q;
}

template <class N>
QuadricAlong<N> quadric_along(const Ray& ray, const Cone& cone) {
  const Vector<N> d(ray.direction);
  const Vector<N> m = Vector<N>(ray.origin) - Vector<N>(cone.apex);
  const Vector<N> axis = Vector<N>(cone.base) - Vector<N>(cone.apex);
  const N length2 = square(axis);
  const N r2 = N(cone.radius_m) * N(cone.radius_m);
  const Vector<N> m_across = cross(m, axis);
  const Vector<N> d_across = cross(d, axis);
  const N start = dot(m, axis);
  const N speed = dot(d, axis);
  QuadricAlong<N> q;
  q.wall.a = square(d_across) * length2 - r2 * (speed * speed);
  q.wall.b = dot(m_across, d_across) * length2 - r2 * (start * speed);
  q.wall.c = square(m_across) * length2 - r2 * (start * start);
  // b^2 - a c without the terms that cancel: the first by Lagrange's identity, the mixed ones as one square.
  const N skew = dot(axis, cross(m, d));
  const Vector<N> mixed = start * d_across - speed * m_across;
  q.wall.discriminant = length2 * (r2 * square(mixed) - length2 * (length2 * (skew * skew)));
  q.plane[0] = {start, speed};
  q.plane[1] = {length2 - start, -speed};
  q.planes = 2;
  return q;
}

template <class N>
QuadricAlong<N> quadric_along(const Ray& ray, const Ellipsoid& ellipsoid) {
  Vector<N> axis[3];
  for (int i = 0; i < 3; ++i) axis[i] = N(ellipsoid.half_m[i]) * Vector<N>(Vec3(ellipsoid.axes.col(i)));
  const Vector<N> d(ray.direction);
  const Vector<N> m = Vector<N>(ray.origin) - Vector<N>(ellipsoid.center);
  const N determinant = dot(axis[0], cross(axis[1], axis[2]));
  const auto seen = [&](const Vector<N>& v) {
    return Vector<N>(dot(v, cross(axis[1], axis[2])), dot(v, cross(axis[2], axis[0])), dot(v, cross(axis[0], axis[1])));
  };
  const Vector<N> u = seen(m);
  const Vector<N> v = seen(d);
  const N det2 = determinant * determinant;
  QuadricAlong<N> q;
  q.wall = {square(v), dot(u, v), square(u) - det2, det2 * square(v) - square(cross(u, v))};
  return q;
}

/// Whether p sqrt(q) + r sqrt(s) + t >= 0, for q, s >= 0.
template <class N>
Decision two_roots_not_negative(const N& p, const N& q, const N& r, const N& s, const N& t) {
  const Decision left_up = at_most(N(0.0), p);
  const Decision rest_up = root_sum_not_negative(t, r, s);
  if (left_up == Decision::undecided || rest_up == Decision::undecided) return Decision::undecided;
  if (left_up == rest_up) return left_up;
  // Compares the square of p sqrt(q) with that of the rest, which still contains a root.
  const N squares = (p * p * q - r * r * s) - t * t;
  const N mixed = N(2.0) * (r * t);
  return left_up == Decision::yes ? root_sum_not_negative(squares, -mixed, s)
                                  : root_sum_not_negative(-squares, mixed, s);
}

/// Where the ray's line crosses the wall, inward (side +1) or outward (-1): (-b - side sqrt(D)) / a, or -c / 2 b if the
/// quadric is linear (a = 0).
template <class N>
class WallRoot {
 public:
  WallRoot(const Quadratic<N>& wall, int side) : wall_(wall), side_(side), sign_a_(sign(wall.a)) {
    const Decision real = at_most(N(0.0), wall.discriminant);
    exists_ = sign_a_ == Sign::unsure ? Decision::undecided : real;
    if (sign_a_ == Sign::zero) exists_ = is_positive(side > 0 ? -wall.b : wall.b);
  }
  Decision exists() const { return exists_; }

  /// Whether p + q s >= 0 at the root; the root must exist.
  Decision not_negative(const N& p, const N& q) const {
    if (sign_a_ == Sign::zero) {
      const N turn(side_ > 0 ? -1.0 : 1.0);  // the sign of b
      return at_most(N(0.0), turn * (N(2.0) * (p * wall_.b) - q * wall_.c));
    }
    const N turn(sign_a_ == Sign::negative ? -1.0 : 1.0);
    return root_sum_not_negative(turn * (p * wall_.a - q * wall_.b), turn * (side_ > 0 ? -q : q), wall_.discriminant);
  }
  /// Whether the root times |d| is at most the ray's length.
  Decision within(const Ray& ray) const {
    if (std::isinf(ray.length_m)) return Decision::yes;
    const N limit(ray.length_m);
    const N dd = square(Vector<N>(ray.direction));
    if (sign_a_ == Sign::zero) return root_sum_not_negative(N(-2.0) * (wall_.b * limit), -wall_.c, dd);
    const N turn(sign_a_ == Sign::negative ? -1.0 : 1.0);
    return two_roots_not_negative(turn, wall_.discriminant * dd, turn * wall_.b, dd, limit * (turn * wall_.a));
  }
  /// Uses the one of the two forms that adds instead of cancelling.
  Scaled parameter() const {
    const Scaled root = side_ > 0 ? root_of_discriminant(wall_) : -root_of_discriminant(wall_);
    const bool b_down = sign(wall_.b) == Sign::negative;
    if (b_down != (side_ > 0)) return (scaled(-wall_.b) - root) / scaled(wall_.a);
    return sign(wall_.c) == Sign::zero ? Scaled{} : scaled(wall_.c) / (scaled(-wall_.b) + root);
  }

 private:
  const Quadratic<N>& wall_;
  int side_;
  Sign sign_a_;
  Decision exists_;
};

/// Whether the ray crosses the wall ahead of its start, between the planes; inward: also within its length.
template <class N>
Decision passes_wall(const QuadricAlong<N>& q, int side, const Ray& ray) {
  const WallRoot<N> root(q.wall, side);
  if (root.exists() != Decision::yes) return root.exists();
  AllOf all;
  if (all.add(root.not_negative(N(0.0), N(1.0)))) return Decision::no;
  for (int i = 0; i < q.planes; ++i) {
    if (all.add(root.not_negative(q.plane[i].offset, q.plane[i].slope))) return Decision::no;
  }
  if (side > 0) all.add(root.within(ray));
  return all.result();
}

/// Whether the ray crosses one of the planes, within the wall and the other plane, at s = -offset / slope.
template <class N>
Decision passes_plane(const QuadricAlong<N>& q, int number, int side, const Ray& ray) {
  const N& u = q.plane[number].offset;
  const N& v = q.plane[number].slope;
  AllOf all;
  if (all.add(is_positive(side > 0 ? v : -v)) || all.add(at_most(N(0.0), side > 0 ? -u : u))) return Decision::no;
  const N level = (q.wall.a * (u * u) - N(2.0) * (q.wall.b * (u * v))) + q.wall.c * (v * v);
  if (all.add(at_most(level, N(0.0)))) return Decision::no;
  const N other = q.plane[1 - number].offset * v - q.plane[1 - number].slope * u;
  if (all.add(at_most(N(0.0), side > 0 ? other : -other))) return Decision::no;
  if (side > 0) all.add(within_length(Reach<N>{Decision::yes, -u, v}, ray));
  return all.result();
}

/// The distance of one crossing along the ray.
template <class N>
Bounded passing_distance(const QuadricAlong<N>& q, int surface, int side, const Ray& ray) {
  if (surface == 2) return plain(WallRoot<N>(q.wall, side).parameter() * length_of<N>(ray));
  return plain(-scaled(q.plane[surface].offset) / scaled(q.plane[surface].slope) * length_of<N>(ray));
}

/// Whether the ray crosses a surface of the shape: 0 and 1 are the planes, 2 is the wall.
template <class Climb, class Shape>
ExactResult passes(const Ray& ray, const Shape& shape, int surface, int side) {
  return Climb::climb([&]<class N>() {
    const QuadricAlong<N> q = quadric_along<N>(ray, shape);
    if (surface == 2) return passes_wall(q, side, ray);
    return surface < q.planes ? passes_plane(q, surface, side, ray) : Decision::no;
  });
}

/// An outward vector at a point of one of the shape's surfaces, of any length.
inline Vec3 outward_at(const Vec3& point, const Cylinder& c, int surface) {
  const Vec3 axis = c.b - c.a;
  if (surface < 2) return surface == 0 ? Vec3(-axis) : axis;
  return from_axis(point, Capsule{c.a, c.b, c.radius_m});
}

inline Vec3 outward_at(const Vec3& point, const Cone& c, int surface) {
  const Vec3 axis = c.base - c.apex;
  if (surface < 2) return surface == 0 ? Vec3(-axis) : axis;
  // Perpendicular to the generator through the point, away from the axis.
  const Vec3 out = unit(from_axis(point, Capsule{c.apex, c.base, c.radius_m}));
  return axis.stableNorm() * out - c.radius_m * unit(axis);
}

inline Vec3 outward_at(const Vec3& point, const Ellipsoid& e, int) {
  Vec3 gradient = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = e.axes.col(i);
    gradient += axis.dot(point - e.center) / (e.half_m[i] * e.half_m[i]) * axis;
  }
  return gradient;
}

template <class Climb, class Shape>
ExactResult cast_quadric(const Ray& ray, const Shape& shape, RayHit& hit) {
  const ExactResult inside = Climb::climb([&]<class N>() { return holds_point<N>(shape, ray.origin); });
  ExactResult verdict = inside;
  Bounded first(std::numeric_limits<double>::max());
  Bounded last;
  int entered = 2;
  int left = 2;
  const auto distance = [&](int surface, int side) {
    return Climb::sharpened(
        [&]<class N>() { return passing_distance(quadric_along<N>(ray, shape), surface, side, ray); });
  };
  for (int surface = 0; surface < 3 && inside.decision == Decision::no; ++surface) {
    const ExactResult part = passes<Climb>(ray, shape, surface, +1);
    verdict = joined(verdict, part);
    if (!part.yes()) continue;
    const Bounded at = distance(surface, +1);
    if (at.value < first.value) entered = surface;
    first = lesser(first, at);
  }
  if (!verdict.yes()) return verdict;
  for (int surface = 0; surface < 3; ++surface) {
    if (!passes<Climb>(ray, shape, surface, -1).yes()) continue;
    const Bounded at = distance(surface, -1);
    if (at.value >= last.value) left = surface;
    last = greater(last, at);
  }
  set_interval(ray, inside.yes(), first, last, hit);
  const Vec3 surface_point = inside.yes() ? at_distance(ray, hit.exit_m) : hit.point;
  set_normal(ray, outward_at(surface_point, shape, inside.yes() ? left : entered), hit);
  return verdict;
}

}  // namespace collided::engine::kernel
