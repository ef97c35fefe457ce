#pragma once

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/exact_phase/kernels/box_kernel.hpp"

namespace collided::engine::kernel {

/// The nearest point of a set to a point p, unrounded: the squared distance is square / scale, away / (a positive
/// number) leads from the set to p, and the foot is base + step / step_scale.
template <class N>
struct Nearest {
  Decision sure = Decision::undecided;
  N square;
  N scale;
  Vector<N> away;
  Vector<N> base;
  Vector<N> step;
  N step_scale;
  int corner = -1;  // index of the segment's or facet's corner that is the nearest point; -1: none
};

template <class N>
Nearest<N> at_corner(const Vector<N>& w, const Vector<N>& corner, int index) {
  const N zero(0.0);
  return {Decision::yes, square(w), N(1.0), w, corner, {zero, zero, zero}, N(1.0), index};
}

/// The corner numbers are those of the segment's ends in their set.
template <class N>
Nearest<N> nearest_on_segment(const Vector<N>& p, const Segment<N>& s, int corner_a = 0, int corner_b = 1) {
  const Vector<N>& d = s.d;
  const Vector<N> w = p - s.a;
  const N along = dot(w, d);
  const N dd = square(d);
  const Sign after_a = sign(along);
  if (after_a == Sign::zero || after_a == Sign::negative) return at_corner(w, s.a, corner_a);
  const Sign before_b = sign(dd - along);
  if (before_b == Sign::zero || before_b == Sign::negative) return at_corner(p - s.b, s.b, corner_b);
  const bool sure = after_a == Sign::positive && before_b == Sign::positive;
  return {
      sure ? Decision::yes : Decision::undecided, square(cross(w, d)), dd, dd * w - along * d, s.a, along * d, dd, -1};
}

/// If p is not above the facet, the nearest point lies on an edge that p is outside of.
template <class N>
Nearest<N> nearest_on_facet(const Vector<N>& p, const Facet<N>& f) {
  const Decision flat = is_zero(f.normal);
  Nearest<N> best;
  if (flat == Decision::undecided) return best;
  std::array<Sign, 3> inward;
  bool inside = flat == Decision::no;
  for (int i = 0; i < 3; ++i) {
    inward[i] = sign(dot(cross(f.normal, f.edge[i]), p - f.corner[i]));
    if (inward[i] == Sign::unsure) return best;
    inside = inside && inward[i] != Sign::negative;
  }
  if (inside) {
    const Vector<N> w = p - f.corner[0];
    const N height = dot(f.normal, w);
    const N nn = square(f.normal);
    return {Decision::yes, height * height, nn, height * f.normal, f.corner[0], nn * w - height * f.normal, nn, -1};
  }
  bool found = false;
  for (int i = 0; i < 3; ++i) {
    if (flat == Decision::no && inward[i] != Sign::negative) continue;
    Nearest<N> next = nearest_on_segment(p, f.side(i), i, (i + 1) % 3);
    if (next.sure == Decision::undecided) return next;
    if (found && next.corner >= 0 && next.corner == best.corner) continue;
    const Decision nearer = found ? less(next.square * best.scale, best.square * next.scale) : Decision::yes;
    if (nearer == Decision::undecided) return {};
    if (nearer == Decision::yes) best = std::move(next);
    found = true;
  }
  return best;
}

/// Position of the nearest point in the box along each axis: at the bound -1 or +1, or 0 for strictly between.
using Pattern = std::array<int, 3>;

/// The pattern by clamping the coordinates of p: right for perpendicular axes, a good guess for others.
Pattern guessed_pattern(const Vec3& p, const Box& box);

template <class N>
Vector<N> signed_reach(const Solid<N>& box, int i, int side) {
  return side > 0 ? box.reach[i] : -box.reach[i];
}

/// Whether side * x >= 0.
template <class N>
Decision on_side(int side, const N& x) {
  return side > 0 ? at_most(N(0.0), x) : at_most(x, N(0.0));
}

template <class N>
Nearest<N> nearest_on_box_face(const Vector<N>& w, const Solid<N>& box, int i, int side) {
  const Vector<N>& n = box.normal[i];
  const Vector<N> from_face = w - signed_reach(box, i, side);
  const N height = dot(from_face, n);
  const N nn = square(n);
  const int j = (i + 1) % 3;
  const int k = (i + 2) % 3;
  const int outward = box.volume == Sign::negative ? -side : side;
  AllOf valid;
  valid.add(on_side(outward, height));
  valid.add(at_most(abs(dot(from_face, cross(box.axis[k], n))), box.half[j] * nn));
  valid.add(at_most(abs(dot(from_face, cross(n, box.axis[j]))), box.half[k] * nn));
  return {valid.result(), height * height, nn, height * n, box.center, nn * w - height * n, nn, -1};
}

template <class N>
Nearest<N> nearest_on_box_edge(const Vector<N>& w, const Solid<N>& box, int k, const Pattern& at) {
  const int i = (k + 1) % 3;
  const int j = (k + 2) % 3;
  const Vector<N>& d = box.axis[k];
  const Vector<N> middle = signed_reach(box, i, at[i]) + signed_reach(box, j, at[j]);
  const Vector<N> v = w - middle;
  const N along = dot(v, d);
  const N dd = square(d);
  AllOf valid;
  valid.add(at_most(abs(along), box.half[k] * dd));
  // The remainder of v must point outward on both sides that meet in the edge.
  valid.add(on_side(at[i], dot(v, box.axis[i]) * dd - dot(d, box.axis[i]) * along));
  valid.add(on_side(at[j], dot(v, box.axis[j]) * dd - dot(d, box.axis[j]) * along));
  return {valid.result(), square(cross(v, d)), dd, dd * v - along * d, box.center, dd * middle + along * d, dd, -1};
}

template <class N>
Nearest<N> nearest_at_box_corner(const Vector<N>& w, const Solid<N>& box, const Pattern& at) {
  const Vector<N> corner = (signed_reach(box, 0, at[0]) + signed_reach(box, 1, at[1])) + signed_reach(box, 2, at[2]);
  const Vector<N> v = w - corner;
  AllOf valid;
  for (int i = 0; i < 3; ++i) valid.add(on_side(at[i], dot(v, box.axis[i])));
  return {valid.result(), square(v), N(1.0), v, box.center, corner, N(1.0), -1};
}

/// The candidate for one pattern; `sure` if it satisfies the conditions of a nearest point (Karush, Kuhn, Tucker;
/// sufficient because the set is convex). The point must be outside the box.
template <class N>
Nearest<N> nearest_at(const Vector<N>& w, const Solid<N>& box, const Pattern& at) {
  const int bound_count = std::abs(at[0]) + std::abs(at[1]) + std::abs(at[2]);
  if (bound_count == 3) return nearest_at_box_corner(w, box, at);
  for (int i = 0; i < 3; ++i) {
    if (bound_count == 1 && at[i] != 0) return nearest_on_box_face(w, box, i, at[i]);
    if (bound_count == 2 && at[i] == 0) return nearest_on_box_edge(w, box, i, at);
  }
  return {};
}

/// For a point outside the box: the guessed feature if it proves right, else the first of all 26 that does.
template <class N>
Nearest<N> nearest_on_solid(const Vector<N>& p, const Solid<N>& box, const Pattern& guess) {
  if (!box.spans()) return {};
  const Vector<N> w = p - box.center;
  Nearest<N> nearest = nearest_at(w, box, guess);
  if (nearest.sure != Decision::no && guess != Pattern{}) return nearest;
  for (int code = 0; code < 27; ++code) {
    nearest = nearest_at(w, box, Pattern{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1});
    if (nearest.sure != Decision::no && code != 13) return nearest;
  }
  return {};
}

/// sqrt(square / scale) - radius, without cancellation: as (q - r^2) / (sqrt(q) + r).
template <class N>
Bounded gap(const Nearest<N>& nearest, const N& radius) {
  const N excess = nearest.square - radius * radius * nearest.scale;
  if (sign(excess) == Sign::zero) return {};
  const Scaled scale = scaled(nearest.scale);
  const Scaled root = sqrt(scaled(nearest.square) / scale);
  return plain(scaled(excess) / scale / (root + scaled(radius)));
}

/// A point, and a bound on its distance from the true one, metres.
struct BoundedPoint {
  Vec3 point;
  double error_m;
};

template <class N>
BoundedPoint foot(const Nearest<N>& nearest) {
  const Scaled scale = scaled(nearest.step_scale);
  BoundedPoint result{Vec3::Zero(), 0};
  const N* base[3] = {&nearest.base.x, &nearest.base.y, &nearest.base.z};
  const N* step[3] = {&nearest.step.x, &nearest.step.y, &nearest.step.z};
  for (int k = 0; k < 3; ++k) {
    const Bounded coordinate = plain(scaled(*base[k])) + plain(scaled(*step[k]) / scale);
    result.point[k] = coordinate.value;
    result.error_m += coordinate.bound();
  }
  return result;
}

/// A nearest point with bounds, ready to report.
struct NearestValue {
  Bounded gap{0, std::numeric_limits<double>::infinity()};
  Vec3 away = Vec3::Zero();  // unit, from the set to p; zero if p is on the set without its radius
  // on the set without its radius
  Vec3 foot = Vec3::Zero();
  double foot_error_m = 0;  // bound on |true foot - foot|
  double away_error = 0;    // bound on |true direction - away|
  bool known = false;
  bool crisp = false;  // gap and direction are precise enough to report
};

/// True if a direction is precise enough to be a normal: moving along it by the depth still separates the shapes.
template <class N>
bool sharp_direction(const Vector<N>&) {
  return true;
}
template <Rounding N>
bool sharp_direction(const Vector<N>& v) {
  const double largest = std::max({std::abs(v.x.value), std::abs(v.y.value), std::abs(v.z.value)});
  const double error = std::max({v.x.bound(), v.y.bound(), v.z.bound()});
  return error <= kRefineDirection * largest && std::isfinite(error);
}

inline bool sharp_direction(const Vector<Scaled>& v) { return sharp_direction(in_range(v)); }

/// Bound on |true unit vector - unit(v)|: |error| / |v| for the direction (the chord of an angle below 2^-30), plus the
/// rounding of the normalisation.
template <class N>
double unit_error(const Vector<N>&) {
  return kUnitVector;
}
template <Rounding N>
double unit_error(const Vector<N>& v) {
  const double largest = std::max({std::abs(v.x.value), std::abs(v.y.value), std::abs(v.z.value)});
  const double error = v.x.bound() + v.y.bound() + v.z.bound();
  constexpr double kSecondOrder = 0x1p-20;  // relative to the largest error
  return largest == 0 ? 0 : error / largest * (1 + kSecondOrder) + kUnitVector;
}
inline double unit_error(const Vector<Scaled>& v) { return unit_error(in_range(v)); }

template <class N>
NearestValue value_of(const Nearest<N>& nearest, const N& radius) {
  if (nearest.sure != Decision::yes) return {};
  const Bounded apart = gap(nearest, radius);
  const bool crisp = sharp(apart, kRefineDistance) && sharp_direction(nearest.away);
  const BoundedPoint on_set = foot(nearest);
  return {apart, unit(nearest.away), on_set.point, on_set.error_m, unit_error(nearest.away), true, crisp};
}

inline bool crisp(const NearestValue& nearest) { return nearest.crisp; }

/// The nearest point of each set, grown by a radius; the sum with the set's own radius is not rounded.
template <class N>
NearestValue nearest_in(const Vec3& point, double radius_m, const Sphere& sphere) {
  const Vector<N> center(sphere.center);
  return value_of(at_corner(Vector<N>(point) - center, center, 0), N(sphere.radius_m) + N(radius_m));
}

template <class N>
NearestValue nearest_in(const Vec3& point, double radius_m, const Box& box) {
  return value_of(nearest_on_solid(Vector<N>(point), Solid<N>(box), guessed_pattern(point, box)), N(radius_m));
}

template <class N>
NearestValue nearest_in(const Vec3& point, double radius_m, const Capsule& capsule) {
  const Segment<N> segment{Vector<N>(capsule.a), Vector<N>(capsule.b)};
  return value_of(nearest_on_segment(Vector<N>(point), segment), N(capsule.radius_m) + N(radius_m));
}

template <class N>
NearestValue nearest_in(const Vec3& point, double radius_m, const Triangle& triangle) {
  return value_of(nearest_on_facet(Vector<N>(point), Facet<N>(triangle)), N(radius_m));
}

template <class Climb, class Shape>
NearestValue nearest_by(const Vec3& point, double radius_m, const Shape& shape) {
  return Climb::sharpened([&]<class N>() { return nearest_in<N>(point, radius_m, shape); });
}

}  // namespace collided::engine::kernel
