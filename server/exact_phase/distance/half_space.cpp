#include "server/exact_phase/distance/half_space.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/distance/half_space_kernel.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"

namespace collided::engine {
namespace {

using namespace kernel;

ExactResult opposite_of(const ExactResult& verdict) { return {opposite(verdict.decision), verdict.level}; }

/// The middle of the face, edge or corner of the set that lies deepest against n, without the ball. In plain double: it
/// is where the contact is drawn; no decision depends on it.
Vec3 deepest_middle(const Convex& set, const Vec3& n) {
  const double slack_m = kClipSlack * (set.reach_m + set.carrier[0].cwiseAbs().maxCoeff());
  if (set.disc_m > 0) {
    const bool lies_on_its_side = set.first_disc == 0 && std::abs(n.dot(set.disc_unit)) < kClipSlack;
    if (!lies_on_its_side) return set.carrier[0] + set.support(-n);
    return set.carrier[0] / 2 + set.carrier[1] / 2 - set.disc_m * n;
  }
  if (set.plus == Convex::Plus::ellipsoid) return set.carrier[0] + set.support(-n);
  double least = n.dot(set.point(0) - set.carrier[0]);
  for (int i = 1; i < set.count(); ++i) least = std::min(least, n.dot(set.point(i) - set.carrier[0]));
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (int i = 0; i < set.count(); ++i) {
    const Vec3 from_first = set.point(i) - set.carrier[0];
    if (n.dot(from_first) > least + slack_m) continue;
    sum += from_first;
    ++count;
  }
  Vec3 middle = sum / count;
  for (int i = 0; set.plus == Convex::Plus::box && i < 3; ++i) {
    const Vec3 axis = set.axes.col(i);
    const double along = n.dot(axis);
    if (std::abs(along) > kClipSlack * axis.norm()) middle -= std::copysign(set.half_m[i], along) * axis;
  }
  return set.carrier[0] + middle;
}

}  // namespace

ExactResult overlaps_half_space(const HalfSpace& a, const ShapeView& b) {
  const Convex set = convex(b);
  return opposite_of(climb([&]<class N>() { return is_ahead<N>(a, set); }));
}

Decision half_space_by_rationals(const HalfSpace& a, const ShapeView& b) {
  return opposite(is_ahead<Dyadic>(a, convex(b)));
}

ExactResult overlaps(const HalfSpace& a, const HalfSpace& b) {
  return opposite_of(climb([&]<class N>() { return are_apart<N>(a, b); }));
}

Decision half_space_by_rationals(const HalfSpace& a, const HalfSpace& b) { return opposite(are_apart<Dyadic>(a, b)); }

Contact contact_half_space(const HalfSpace& a, const ShapeView& b) {
  const Convex set = convex(b);
  const Vec3 normal = unit(a.normal);
  const Bounded depth = reach_value(set, a.normal, -1, a.point) / sqrt(square(Vector<Bounded>(a.normal)));
  const double depth_m = std::max(depth.value, 0.0);
  const Vec3 deepest = deepest_middle(set, normal) - set.ball_m * normal;
  return {deepest + depth_m / 2 * normal, normal, depth_m, depth.bound() + std::abs(depth_m - depth.value)};
}

Contact contact(const HalfSpace& a, const HalfSpace&) {
  // Two overlapping half-spaces overlap without bound, so no finite push separates them.
  return {a.point, unit(a.normal), 0, std::numeric_limits<double>::infinity()};
}

Closest closest(const Vec3& point, const HalfSpace& half_space) {
  return closest_half_space<WholeLadder>(point, half_space);
}

ExactResult cast_ray(const Ray& ray, const HalfSpace& half_space, RayHit& hit) {
  return cast_half_space<WholeLadder>(ray, half_space, hit);
}

}  // namespace collided::engine
