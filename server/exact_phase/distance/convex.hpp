#pragma once

#include "server/exact_phase/arithmetic/number.hpp"
#include "server/exact_phase/distance/core.hpp"
#include "server/geometry/pose.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// The common form of all convex shapes: the hull of a few points (carriers), of which those from first_disc on carry a
/// disc, plus a box or an ellipsoid, plus a ball. For solvers that use only a set's reach along a direction.
struct Convex {
  Vec3 carrier[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  int carrier_count = 1;
  const Hull* hull = nullptr;  // not owned; its placed vertices are the carriers, the first in carrier[0]
  enum class Plus { nothing, box, ellipsoid } plus = Plus::nothing;
  Mat3 axes = Mat3::Zero();
  Vec3 half_m = Vec3::Zero();
  double ball_m = 0;
  double disc_m = 0;  // radius of the discs around carriers from first_disc on, perpendicular to disc_axis
  int first_disc = 0;
  EdgeDirection disc_axis;
  Vec3 disc_unit = Vec3::UnitZ();  // the axis as a unit vector, rounded
  double reach_m = 0;              // upper bound on the distance of any point, without the ball, from carrier[0]

  /// A point well inside the set, relative to carrier[0], to start a search from.
  Vec3 middle() const;

  explicit Convex(const Sphere& s);
  explicit Convex(const Box& b);
  explicit Convex(const Capsule& c);
  explicit Convex(const Triangle& t);
  explicit Convex(const Cylinder& c);
  explicit Convex(const Cone& c);
  explicit Convex(const Ellipsoid& e);
  /// Keeps a pointer to the hull, which must outlive this.
  explicit Convex(const Hull& h);

  /// Number of carriers.
  int count() const { return hull != nullptr ? hull_count : carrier_count; }
  Vec3 point(int i) const;
  /// Flat facets and a ball: any two such sets are decided exactly.
  bool is_polytope() const { return plus != Plus::ellipsoid && disc_m == 0; }

  /// Approximate farthest point along n, without the ball, relative to carrier[0].
  Vec3 support(const Vec3& n) const;

 private:
  int hull_count = 0;
  Vec3 hull_middle_ = Vec3::Zero();  // relative to carrier[0]
};

/// The reach of a part of a set along a direction, as rational + sqrt(numerator / denominator).
template <class N>
struct ReachPart {
  N rational;
  N numerator;
  N denominator;
};

/// The reach of a set along n from `origin`, times |n|: the larger of its parts (cones have two).
template <class N>
struct ReachAlong {
  ReachPart<N> part[2];
  int count = 0;
};

template <class N>
ReachAlong<N> reach_along(const Convex& set, const Vector<N>& n, const Vec3& origin) {
  const auto along = [&](int i) { return dot(n, Vector<N>(set.point(i)) - Vector<N>(origin)); };
  const auto farthest = [&](int first, int end) {
    N most = along(first);
    for (int i = first + 1; i < end; ++i) most = max(most, along(i));
    return most;
  };
  ReachAlong<N> reach;
  const N nn = square(n);
  const N zero(0.0);
  const N one(1.0);
  if (set.disc_m > 0) {
    const Vector<N> axis = Vector<N>(set.disc_axis.to) - Vector<N>(set.disc_axis.from);
    const N radius(set.disc_m);
    reach.part[reach.count++] = {farthest(set.first_disc, set.count()), radius * radius * square(cross(n, axis)),
                                 square(axis)};
    if (set.first_disc > 0) reach.part[reach.count++] = {farthest(0, set.first_disc), zero, one};
    return reach;
  }
  ReachPart<N> part{farthest(0, set.count()), zero, one};
  if (set.ball_m > 0) part.numerator = N(set.ball_m) * N(set.ball_m) * nn;
  for (int i = 0; set.plus != Convex::Plus::nothing && i < 3; ++i) {
    const N extent = N(set.half_m[i]) * dot(n, Vector<N>(Vec3(set.axes.col(i))));
    if (set.plus == Convex::Plus::box) part.rational = part.rational + abs(extent);
    else part.numerator = part.numerator + extent * extent;
  }
  reach.part[reach.count++] = std::move(part);
  return reach;
}

/// side +1: along n; -1: along -n, so that one vector serves both sets of a pair.
template <class N>
ReachAlong<N> reach_along(const Convex& set, const Vec3& n, int side, const Vec3& origin) {
  return reach_along<N>(set, side > 0 ? Vector<N>(n) : -Vector<N>(n), origin);
}

/// Whether p + sqrt(q) + sqrt(r) < 0, with the roots' arguments as quotients with positive denominators.
template <class N>
Decision root_sum_negative(const N& p, const ReachPart<N>& q, const ReachPart<N>& r) {
  const Decision below = less(p, N(0.0));
  if (below != Decision::yes) return below;
  // Squares both sides of sqrt(q) + sqrt(r) < -p, and then squares the remaining root terms.
  const N rest = (p * p * q.denominator * r.denominator - q.numerator * r.denominator) - r.numerator * q.denominator;
  const Decision room = is_positive(rest);
  if (room != Decision::yes) return room;
  const N product = q.numerator * r.denominator * (r.numerator * q.denominator);
  return less(N(4.0) * product, rest * rest);
}

/// True if two sets with these reaches towards each other along a line, from one origin, share no point of it.
template <class N>
Decision parted(const ReachAlong<N>& reach_a, const ReachAlong<N>& reach_b) {
  AllOf all;
  for (int i = 0; i < reach_a.count; ++i) {
    for (int j = 0; j < reach_b.count; ++j) {
      const N p = reach_a.part[i].rational + reach_b.part[j].rational;
      if (all.add(root_sum_negative(p, reach_a.part[i], reach_b.part[j]))) return Decision::no;
    }
  }
  return all.result();
}

/// True if some plane perpendicular to n has the two sets strictly on opposite sides, b ahead.
template <class N>
Decision parted_along(const Vector<N>& n, const Convex& a, const Convex& b) {
  const Vec3& origin = b.carrier[0];
  return parted(reach_along<N>(a, n, origin), reach_along<N>(b, -n, origin));
}
template <class N>
Decision parted_along(const Vec3& n, const Convex& a, const Convex& b) {
  return parted_along<N>(Vector<N>(n), a, b);
}

/// The reach of the set along n (side +1) or against it (-1) from the origin, times |n|.
Bounded reach_value(const Convex& set, const Vec3& n, int side, const Vec3& origin);

/// How far b must move along n, of any length, until the sets only touch, in metres; negative: they are separate.
Bounded push_along(const Vec3& n, const Convex& a, const Convex& b);

}  // namespace collided::engine::kernel
