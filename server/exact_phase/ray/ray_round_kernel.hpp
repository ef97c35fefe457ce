#pragma once

#include <algorithm>
#include <type_traits>

#include "server/exact_phase/kernels/overlap_kernel.hpp"
#include "server/exact_phase/ray/ray_hit_value.hpp"

namespace collided::engine::kernel {

/// Where a ray is inside a round shape: a s^2 + 2 b s + c <= 0. The quarter discriminant b^2 - a c is computed
/// separately, because a cross product gives it without cancellation.
template <class N>
struct Quadratic {
  N a;
  N b;
  N c;
  N discriminant;
};

template <class N>
Quadratic<N> ball_along(const Ray& ray, const Vec3& center, double radius_m) {
  const Vector<N> d(ray.direction);
  const Vector<N> m = Vector<N>(ray.origin) - Vector<N>(center);
  const N r2 = N(radius_m) * N(radius_m);
  const N dd = square(d);
  return {dd, dot(m, d), square(m) - r2, r2 * dd - square(cross(m, d))};
}

/// The ray along a ball, with the first rung's numbers kept for the test and both distances.
struct BallAlong {
  const Ray& ray;
  const Vec3& center;
  double radius_m;
  Quadratic<Bounded> quick = ball_along<Bounded>(ray, center, radius_m);

  template <class N>
  decltype(auto) quadratic() const {
    if constexpr (std::is_same_v<N, Bounded>) return (quick);
    else return ball_along<N>(ray, center, radius_m);
  }
};

template <class N>
Quadratic<N> cylinder_along(const Ray& ray, const Capsule& capsule) {
  const Vector<N> d(ray.direction);
  const Vector<N> m = Vector<N>(ray.origin) - Vector<N>(capsule.a);
  const Vector<N> axis = Vector<N>(capsule.b) - Vector<N>(capsule.a);
  const N r2 = N(capsule.radius_m) * N(capsule.radius_m);
  const N ww = square(axis);
  const Vector<N> m_across = cross(m, axis);
  const Vector<N> d_across = cross(d, axis);
  const N dd = square(d_across);
  const N skew = dot(axis, cross(m, d));
  return {dd, dot(m_across, d_across), square(m_across) - r2 * ww, ww * (r2 * dd - skew * skew)};
}

/// Whether the first root lies ahead of the start and within the length, for a start outside (c > 0).
template <class N>
Decision enters(const Quadratic<N>& q, const Ray& ray) {
  AllOf all;
  if (all.add(is_positive(-q.b))) return Decision::no;
  if (all.add(at_most(N(0.0), q.discriminant))) return Decision::no;
  if (std::isinf(ray.length_m)) return all.result();
  // The end at L |d|^-1 is past the vertex of the parabola, or inside: a L^2 + c d.d <= 2 |b| L |d|.
  const N dd = square(Vector<N>(ray.direction));
  const N limit = N(ray.length_m);
  const N limit2 = limit * limit;
  const N past = q.a * limit2 + q.c * dd;
  AnyOf reaches;
  if (!reaches.add(at_most(q.b * q.b * dd, limit2 * (q.a * q.a))) && !reaches.add(at_most(past, N(0.0)))) {
    reaches.add(at_most(past * past, N(4.0) * (limit2 * (q.b * q.b * dd))));
  }
  all.add(reaches.result());
  return all.result();
}

template <class N>
Scaled root_of_discriminant(const Quadratic<N>& q) {
  return sign(q.discriminant) == Sign::negative ? Scaled{} : sqrt(scaled(q.discriminant));
}

/// The first root, for b < 0 and c >= 0: c / (-b + sqrt(D)) adds instead of cancelling like the textbook form.
template <class N>
Scaled entry(const Quadratic<N>& q) {
  if (sign(q.c) == Sign::zero) return {};
  return scaled(q.c) / (scaled(-q.b) + root_of_discriminant(q));
}

/// The second root, for c <= 0 or b < 0.
template <class N>
Scaled exit(const Quadratic<N>& q) {
  const Scaled root = root_of_discriminant(q);
  if (sign(q.b) == Sign::negative) return (scaled(-q.b) + root) / scaled(q.a);
  if (sign(q.c) == Sign::zero) return {};
  return scaled(-q.c) / (scaled(q.b) + root);
}

template <class Climb>
ExactResult enters(const BallAlong& ball) {
  return Climb::climb([&]<class N>() { return enters(ball.quadratic<N>(), ball.ray); });
}

template <class Climb>
Bounded entry_distance(const BallAlong& ball) {
  return Climb::sharpened([&]<class N>() { return plain(entry(ball.quadratic<N>()) * length_of<N>(ball.ray)); });
}

template <class Climb>
Bounded exit_distance(const BallAlong& ball) {
  return Climb::sharpened([&]<class N>() { return plain(exit(ball.quadratic<N>()) * length_of<N>(ball.ray)); });
}

template <class Climb, class Shape>
ExactResult starts_inside_by(const Ray& ray, const Shape& shape) {
  return Climb::climb([&]<class N>() { return sets_meet<N>(Sphere{ray.origin, 0}, shape); });
}

template <class Climb>
ExactResult cast_solid(const Ray& ray, const Sphere& sphere, RayHit& hit) {
  const ExactResult inside = starts_inside_by<Climb>(ray, sphere);
  const BallAlong ball{.ray = ray, .center = sphere.center, .radius_m = sphere.radius_m};
  ExactResult verdict = inside;
  if (inside.decision != Decision::yes) verdict = joined(inside, enters<Climb>(ball));
  if (!verdict.yes()) return verdict;
  const bool starts_inside = inside.yes();
  const Bounded first = starts_inside ? Bounded() : entry_distance<Climb>(ball);
  const Bounded leave = exit_distance<Climb>(ball);
  set_interval(ray, starts_inside, first, leave, hit);
  const Vec3 surface = starts_inside ? at_distance(ray, hit.exit_m) : hit.point;
  set_normal(ray, sphere.radius_m > 0 ? Vec3(surface - sphere.center) : Vec3(Vec3::Zero()), hit);
  return verdict;
}

/// Whether p + q sqrt(r) >= 0, for r >= 0.
template <class N>
Decision root_sum_not_negative(const N& p, const N& q, const N& r) {
  const Decision p_up = at_most(N(0.0), p);
  const Decision q_up = at_most(N(0.0), q);
  if (p_up == Decision::yes && q_up == Decision::yes) return Decision::yes;
  const N p2 = p * p;
  const N q2r = q * q * r;
  if (p_up == Decision::yes && q_up == Decision::no) return at_most(q2r, p2);
  if (p_up == Decision::no && q_up == Decision::yes) return at_most(p2, q2r);
  return p_up == Decision::no && q_up == Decision::no ? Decision::no : Decision::undecided;
}

/// Whether the ray enters the round wall between the capsule's two ends. (Entries through the ends are entries of a
/// ball.)
template <class N>
Decision enters_wall(const Ray& ray, const Capsule& capsule) {
  const Vector<N> axis = Vector<N>(capsule.b) - Vector<N>(capsule.a);
  const Decision no_axis = is_zero(axis);
  if (no_axis == Decision::yes) return Decision::no;
  const Quadratic<N> q = cylinder_along<N>(ray, capsule);
  AllOf all;
  if (all.add(is_positive(q.c)) || all.add(enters(q, ray))) return Decision::no;
  // Along the axis the entry is at start + speed s with s = (-b - sqrt(D)) / a; everything is multiplied by a.
  const N start = dot(Vector<N>(ray.origin) - Vector<N>(capsule.a), axis);
  const N speed = dot(Vector<N>(ray.direction), axis);
  const N at = start * q.a - speed * q.b;
  if (all.add(root_sum_not_negative(at, -speed, q.discriminant))) return Decision::no;
  all.add(root_sum_not_negative(square(axis) * q.a - at, speed, q.discriminant));
  return all.result();
}

/// The vector from the nearest point of the capsule's axis to the point.
inline Vec3 from_axis(const Vec3& point, const Capsule& capsule) {
  const Vec3 axis = unit(Vec3(capsule.b - capsule.a));
  const double length = (capsule.b - capsule.a).stableNorm();
  const double along = std::clamp((point - capsule.a).dot(axis), 0.0, length);
  return (point - capsule.a) - along * axis;
}

/// The second root on the round wall, as a distance, if it lies between the capsule's two ends; else 0.
template <class N>
Bounded wall_exit(const Ray& ray, const Capsule& capsule) {
  const Quadratic<N> q = cylinder_along<N>(ray, capsule);
  const Vector<N> axis = Vector<N>(capsule.b) - Vector<N>(capsule.a);
  if (sign(q.discriminant) == Sign::negative || sign(q.a) == Sign::zero) return {};
  if (sign(q.b) != Sign::negative && sign(q.c) == Sign::positive) return {};
  const Scaled parameter = exit(q);
  if (!std::isfinite(parameter.value.error)) return {0, std::numeric_limits<double>::infinity()};
  const N start = dot(Vector<N>(ray.origin) - Vector<N>(capsule.a), axis);
  const N speed = dot(Vector<N>(ray.direction), axis);
  const Bounded along = plain((scaled(start) + scaled(speed) * parameter) / scaled(square(axis)));
  // At the seam wall and ball touch: on the last rung a rounding e that puts the exit on the wrong side changes it only
  // by e^2.
  if constexpr (Inexact<N>) {
    if (!(along.low() >= 0 && along.high() <= 1) && !(along.high() < 0 || along.low() > 1)) {
      return {0, std::numeric_limits<double>::infinity()};
    }
  }
  if (!(along.value >= 0 && along.value <= 1)) return {};
  return plain(parameter * length_of<N>(ray));
}

/// Where the line leaves the capsule: the last exit from its two balls and, between the ends, its wall.
template <class Climb>
Bounded capsule_exit(const Ray& ray, const Capsule& capsule) {
  Bounded last = Climb::sharpened([&]<class N>() { return wall_exit<N>(ray, capsule); });
  for (const Vec3& end : {capsule.a, capsule.b}) {
    const BallAlong ball{.ray = ray, .center = end, .radius_m = capsule.radius_m};
    const Bounded leave = Climb::sharpened([&]<class N>() {
      const Quadratic<N>& q = ball.quadratic<N>();
      const bool behind = sign(q.b) != Sign::negative && sign(q.c) == Sign::positive;
      return behind || sign(q.discriminant) == Sign::negative ? Bounded() : plain(exit(q) * length_of<N>(ray));
    });
    last = greater(last, leave);
  }
  return last;
}

template <class Climb>
ExactResult cast_solid(const Ray& ray, const Capsule& capsule, RayHit& hit) {
  const ExactResult inside = starts_inside_by<Climb>(ray, capsule);
  ExactResult verdict = inside;
  Bounded first(std::numeric_limits<double>::max());
  const auto consider = [&](const ExactResult& part, const auto& distance) {
    verdict = joined(verdict, part);
    if (part.yes()) first = lesser(first, distance());
  };
  if (inside.decision == Decision::no) {
    for (const Vec3& end : {capsule.a, capsule.b}) {
      const BallAlong ball{.ray = ray, .center = end, .radius_m = capsule.radius_m};
      consider(enters<Climb>(ball), [&] { return entry_distance<Climb>(ball); });
    }
    consider(Climb::climb([&]<class N>() { return enters_wall<N>(ray, capsule); }), [&] {
      return Climb::sharpened(
          [&]<class N>() { return plain(entry(cylinder_along<N>(ray, capsule)) * length_of<N>(ray)); });
    });
  }
  if (!verdict.yes()) return verdict;
  set_interval(ray, inside.yes(), first, capsule_exit<Climb>(ray, capsule), hit);
  const Vec3 surface = inside.yes() ? at_distance(ray, hit.exit_m) : hit.point;
  set_normal(ray, capsule.radius_m > 0 ? from_axis(surface, capsule) : Vec3(Vec3::Zero()), hit);
  return verdict;
}

}  // namespace collided::engine::kernel
