#pragma once

#include <limits>

#include "server/exact_phase/arithmetic/ladder.hpp"
#include "server/exact_phase/distance/closest_kernel.hpp"
#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/kernels/ray_kernel.hpp"
#include "server/exact_phase/ray/ray_hit_value.hpp"

namespace collided::engine::kernel {

/// Whether the convex set lies strictly outside of the half-space.
template <class N>
Decision is_ahead(const HalfSpace& a, const Convex& b) {
  const ReachAlong<N> reach = reach_along<N>(b, a.normal, -1, a.point);
  const ReachPart<N> none{N(0.0), N(0.0), N(1.0)};
  AllOf all;
  for (int i = 0; i < reach.count; ++i) {
    if (all.add(root_sum_negative(reach.part[i].rational, reach.part[i], none))) return Decision::no;
  }
  return all.result();
}

/// Whether the two normals are opposite and the planes leave a gap.
template <class N>
Decision are_apart(const HalfSpace& a, const HalfSpace& b) {
  const Vector<N> n(a.normal);
  const Vector<N> m(b.normal);
  const Vector<N> turn = cross(n, m);
  AllOf all;
  if (all.add(is_zero(turn.x)) || all.add(is_zero(turn.y)) || all.add(is_zero(turn.z))) return Decision::no;
  if (all.add(less(dot(n, m), N(0.0)))) return Decision::no;
  all.add(is_positive(dot(n, Vector<N>(b.point) - Vector<N>(a.point))));
  return all.result();
}

/// The height of a point over the plane, times |normal|.
template <class N>
N ahead_of(const HalfSpace& h, const Vec3& point) {
  return dot(Vector<N>(h.normal), Vector<N>(point) - Vector<N>(h.point));
}

/// The distance along the ray to the plane; the ray must meet it.
template <class Climb>
Bounded distance_to_plane(const Ray& ray, const HalfSpace& h) {
  return Climb::sharpened([&]<class N>() {
    const N slope = dot(Vector<N>(h.normal), Vector<N>(ray.direction));
    return plain(-scaled(ahead_of<N>(h, ray.origin)) / scaled(slope) * length_of<N>(ray));
  });
}

/// Same as cast_ray: a hit where the ray enters or starts inside; it leaves, or exit_m is infinite.
template <class Climb>
ExactResult cast_half_space(const Ray& ray, const HalfSpace& h, RayHit& hit) {
  const auto slope_is = [&](int side) {
    return Climb::climb([&]<class N>() {
      const N slope = dot(Vector<N>(h.normal), Vector<N>(ray.direction));
      return is_positive(side > 0 ? slope : -slope);
    });
  };
  const ExactResult inside = Climb::climb([&]<class N>() { return at_most(ahead_of<N>(h, ray.origin), N(0.0)); });
  ExactResult verdict = inside;
  if (inside.decision == Decision::no) {
    const ExactResult enters = Climb::climb([&]<class N>() {
      const N slope = dot(Vector<N>(h.normal), Vector<N>(ray.direction));
      return both(is_positive(-slope), within_length(Reach<N>{Decision::yes, ahead_of<N>(h, ray.origin), -slope}, ray));
    });
    verdict = {enters.decision, std::max(inside.level, enters.level)};
  }
  if (!verdict.yes()) return verdict;
  const bool leaves = inside.yes() && slope_is(+1).yes();
  const Bounded passing = leaves || !inside.yes() ? distance_to_plane<Climb>(ray, h) : Bounded();
  set_interval(ray, inside.yes(), passing, passing, hit);
  if (!leaves) {
    hit.exit_m = std::numeric_limits<double>::infinity();
    hit.exit_error_m = 0;
  }
  set_normal(ray, h.normal, hit);
  return verdict;
}

template <class Climb>
Closest closest_half_space(const Vec3& point, const HalfSpace& h) {
  const Vec3 normal = unit(h.normal);
  const ExactResult held = Climb::climb([&]<class N>() { return at_most(ahead_of<N>(h, point), N(0.0)); });
  if (held.yes()) return inside_at(point, normal);
  const Bounded ahead = Climb::sharpened(
      [&]<class N>() { return plain(scaled(ahead_of<N>(h, point)) / sqrt(scaled(square(Vector<N>(h.normal))))); });
  const double distance_m = std::max(ahead.value, 0.0);
  Closest result{distance_m, ahead.bound() + (distance_m - ahead.value), point - distance_m * normal, normal};
  // The error of the distance, of the unit vector (4 u) and of their product, and of the difference in each coordinate.
  result.point_error_m =
      (result.distance_error_m + 8 * kRoundoff * distance_m + kPointSum * result.point.cwiseAbs().maxCoeff()) *
          (1 + kBoundSlack) +
      kUnderflow;
  return result;
}

}  // namespace collided::engine::kernel
