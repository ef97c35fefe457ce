#include "server/exact_phase/distance/contact.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <variant>

#include "server/exact_phase/arithmetic/ladder.hpp"
#include "server/exact_phase/distance/box_contact.hpp"
#include "server/exact_phase/distance/box_push.hpp"
#include "server/exact_phase/distance/core.hpp"
#include "server/exact_phase/distance/facet_filter.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/distance/nearest_value.hpp"
#include "server/exact_phase/overlap/box_lanes.hpp"
#include "server/exact_phase/overlap/overlap.hpp"

namespace collided::engine {
namespace {

using namespace kernel;

Contact flipped(Contact c) {
  c.normal = -c.normal;
  return c;
}

Contact make_contact(const Vec3& point, const Vec3& normal, const Bounded& depth) {
  // Cores that touch in exact arithmetic may come out slightly below zero.
  const double depth_m = std::max(depth.value, 0.0);
  return {point, normal, depth_m, depth.bound() + std::abs(depth_m - depth.value)};
}

/// Halfway into the overlap: from the rounded surface of a core towards the other.
Vec3 middle_along(const Vec3& on_a, double radius_a_m, const Vec3& normal, double depth_m) {
  return on_a + (radius_a_m - depth_m / 2) * normal;
}

/// For a sphere whose centre is outside the core of `other` or on it: the depth is the sum of the radii less the
/// distance.
Contact ball_contact(const Sphere& a, double other_radius_m, const NearestValue& nearest, const Vec3& fallback) {
  const Vec3 towards = nearest.away.isZero(0) ? fallback : nearest.away;
  const Vec3 normal = -towards;
  const Contact contact = make_contact(a.center, normal, -nearest.gap);
  // Seen from b: its surface, half the depth inward.
  return {middle_along(nearest.foot, other_radius_m, towards, contact.depth_m), normal, contact.depth_m,
          contact.depth_error_m};
}

/// An upper bound on the distance between any two points of the pair.
double size_of(const Core& a, const Core& b) {
  double size = 0;
  for (const Core* core : {&a, &b}) {
    for (int i = 0; i < core->point_count; ++i) size += (core->point[i] - a.point[0]).cwiseAbs().sum();
    if (core->is_box) size += 2 * core->span_m;
  }
  return size;
}

/// The translation of b along one facet axis that separates the two, in the direction that needs less.
struct Push {
  Bounded depth;
  Vec3 normal;
  bool exists = false;
};

template <class N>
FacetPush<N> facet_push(const FacetAxis& axis, const Core& a, const Core& b) {
  if constexpr (std::same_as<N, Bounded>) {
    if (a.is_box && b.is_box) return facet_push_of_boxes(axis, a, b);
  }
  const Vector<N> n = direction<N>(axis);
  return {n, square(n), pushes_along(n, a, b)};
}

template <class N>
Push push_out(const FacetAxis& axis, const Core& a, const Core& b) {
  const FacetPush<N> along = facet_push<N>(axis, a, b);
  if (is_zero(along.n) == Decision::yes) return {.depth = {}, .normal = Vec3::Zero()};
  const Scaled length = sqrt(scaled(along.square));
  const Bounded forward = plain(scaled(along.push.forward) / length);
  const Bounded backward = plain(scaled(along.push.backward) / length);
  const Vec3 normal = unit(along.n);
  return backward.value < forward.value ? Push{backward, -normal, true} : Push{forward, normal, true};
}

/// Computed with actual errors, which are zero for small integers, or exactly if that is still too wide.
Push push_out_sharply(const FacetAxis& axis, const Core& a, const Core& b) {
  const Push traced = push_out<Traced>(axis, a, b);
  return traced.exists && sharp(traced.depth, kRefineRay) ? traced : push_out<Dyadic>(axis, a, b);
}

/// The pushes along the facet axes of a pair that may be the least.
class PushList {
 public:
  /// may_be_least: result of axes_of_least_push(), if known.
  PushList(const Core& a, const Core& b, std::optional<std::uint32_t> may_be_least)
      : a_(a), b_(b), are_boxes_(a.is_box && b.is_box) {
    if (!are_boxes_) axes_ = facet_axes(a, b);
    left_ = may_be_least ? *may_be_least : axes_of_least_push(axes_, a, b);
    for_each([&](int i) { push_[i] = push_out<Bounded>(axis(i), a, b); });
  }

  double least_high() const {
    double least = std::numeric_limits<double>::infinity();
    for_each([&](int i) { least = push_[i].exists ? std::min(least, push_[i].depth.high()) : least; });
    return least;
  }

  /// Recomputes the pushes that may be the least and are not known to within `blunt`.
  void sharpen(double blunt) {
    const double least = least_high();
    for_each([&](int i) {
      if (competes(i, least) && !(push_[i].depth.bound() <= blunt)) push_[i] = push_out_sharply(axis(i), a_, b_);
    });
  }

  /// The smallest push, its depth widened over all pushes that may be smaller. Depths within `blunt` of each other keep
  /// the earlier axis: faces before edge pairs, in a fixed order.
  Push least(double blunt) const {
    const double high = least_high();
    Push winner{.depth = {}, .normal = Vec3::Zero()};
    Bounded depth(std::numeric_limits<double>::max());
    for_each([&](int i) {
      if (!competes(i, high)) return;
      depth = lesser(depth, push_[i].depth);
      if (!winner.exists || push_[i].depth.value < winner.depth.value - blunt) winner = push_[i];
    });
    winner.depth = depth;
    return winner;
  }

 private:
  bool competes(int i, double least) const { return push_[i].exists && push_[i].depth.low() <= least; }
  FacetAxis axis(int i) const { return are_boxes_ ? facet_axis_of_boxes(a_, b_, i) : axes_.axis[i]; }
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (std::uint32_t left = left_; left != 0; left &= left - 1) visit(std::countr_zero(left));
  }

  const Core& a_;
  const Core& b_;
  bool are_boxes_;
  FacetAxes axes_;  // for two boxes computed one by one, since mostly one is needed
  std::uint32_t left_ = 0;
  std::array<Push, 15> push_;  // the remaining ones
};

/// The smallest push that separates two cores with a common point: the nearest facet of the Minkowski difference. If
/// the difference is flat and all facet axes vanish, there is no push, and the depth is zero.
Push least_push(const Core& a, const Core& b, std::optional<std::uint32_t> may_be_least) {
  PushList list(a, b, may_be_least);
  const double blunt = kRefineDistance * size_of(a, b);
  list.sharpen(blunt);
  const Push least = list.least(blunt);
  if (!least.exists || sharp(least.depth, kRefineRay)) return least;
  // Barely touching: recovers the cancelled digits, so that a touch is exactly zero.
  list.sharpen(-1);
  return list.least(0);
}

Vec3 edge_normal(const Core& core) { return any_normal(Vec3(core.point[1] - core.point[0])); }

/// A normal if no facet gives one.
Vec3 normal_without_facets(const Core& a, const Core& b) {
  if (a.point_count == 3) return any_normal(Triangle{a.point[0], a.point[1], a.point[2]});
  if (b.point_count == 3) return any_normal(Triangle{b.point[0], b.point[1], b.point[2]});
  if (a.point_count == 2 && a.point[0] != a.point[1]) return edge_normal(a);
  return b.point_count == 2 ? edge_normal(b) : Vec3(Vec3::UnitX());
}

/// For cores that share a point: the push out of each other plus both radii. may_be_least as in PushList.
Contact contact_of_meeting_cores(const Core& a, const Core& b, std::optional<std::uint32_t> may_be_least) {
  Push push = least_push(a, b, may_be_least);
  if (!push.exists) push = {Bounded(), normal_without_facets(a, b), true};
  const Bounded depth = push.depth + Bounded(a.radius_m) + Bounded(b.radius_m);
  return make_contact(middle_of_both(a, b, push.normal), push.normal, depth);
}

/// The depth is at most the push along any separating direction: uses the direction between the witnesses, or, if they
/// are so close that rounding determines it, the best facet axis.
Push best_known_push(const Core& a, const Core& b, const WitnessPair& pair, double low_m) {
  Push best{Bounded(0, std::numeric_limits<double>::infinity()), normal_without_facets(a, b), true};
  const Vec3 across = unit(Vec3(pair.on_b - pair.on_a));
  const Vec3 fallback = best.normal;
  for (const Vec3& normal : {across, fallback}) {
    if (normal.isZero(0)) continue;
    const Vector<Bounded> n(normal);
    const Bounded push = pushes_along(n, a, b).forward / sqrt(square(n));
    if (push.high() < best.depth.high()) best = {push, normal, true};
    if (best.depth.high() - low_m <= kRefineRay * size_of(a, b)) return best;
  }
  const FacetAxes axes = facet_axes(a, b);
  for (int i = 0; i < axes.count; ++i) {
    const Push push = push_out<Dyadic>(axes.axis[i], a, b);
    if (push.exists && push.depth.high() < best.depth.high()) best = push;
  }
  return best;
}

/// For cores apart with overlapping rounded surfaces. Two witnesses bound the distance from above, a plane between them
/// from below; both bounds hold however good the witnesses are.
Contact contact_of_apart_cores(const Core& a, const Core& b) {
  const WitnessPair pair = nearest_witnesses(a, b);
  const double apart_m = (pair.on_b - pair.on_a).stableNorm();
  // The witnesses are off their cores by roundings of the extents, the norm by roundings of its own.
  const Bounded apart(apart_m, kWitnessError * (extent(a) + extent(b)) + 16 * kRoundoff * apart_m);
  const Bounded radii = Bounded(a.radius_m) + Bounded(b.radius_m);
  const Push push = best_known_push(a, b, pair, -apart.high());
  const double low = std::max((radii - apart).low(), 0.0);
  const double high = std::max((radii + push.depth).high(), low);
  const double middle = low + (high - low) / 2;
  const Bounded depth(middle, (high - low) / 2 + 2 * kRoundoff * high);
  return make_contact(middle_along(pair.on_a, a.radius_m, push.normal, middle), push.normal, depth);
}

/// Solves at a size near 1 and scales back, because squares of tiny and huge coordinates leave the range of double. A
/// power of two changes no digits, except of coordinates that vanish relative to the extent.
template <class Solve>
Contact at_unit_size(const Core& a, const Core& b, const Solve& solve) {
  const double largest = std::max(extent(a) + a.radius_m, extent(b) + b.radius_m);
  int power = 0;
  if (std::isfinite(largest)) std::frexp(largest, &power);
  if (std::abs(power) < 200) return solve(a, b);
  Core near_one_a = a;
  Core near_one_b = b;
  scale(near_one_a, -power);
  scale(near_one_b, -power);
  Contact contact = solve(near_one_a, near_one_b);
  for (double& x : contact.point) x = std::ldexp(x, power);
  contact.depth_m = std::ldexp(contact.depth_m, power);
  contact.depth_error_m = std::ldexp(contact.depth_error_m + kRoundoff, power);
  return contact;
}

Contact contact_of_cores(const Core& a, const Core& b, bool cores_meet) {
  return at_unit_size(a, b, [cores_meet](const Core& own_a, const Core& own_b) {
    return cores_meet ? contact_of_meeting_cores(own_a, own_b, std::nullopt) : contact_of_apart_cores(own_a, own_b);
  });
}

}  // namespace

namespace {

/// nearest_value() of two spheres without the bounds of foot and direction, which a contact does not need: the foot is
/// the centre, so the quotients for it are left out.
template <class N>
NearestValue nearest_of_balls(const Sphere& a, const Sphere& b) {
  const Vector<N> center(b.center);
  const Nearest<N> nearest = at_corner(Vector<N>(a.center) - center, center, 0);
  NearestValue value;
  value.gap = gap(nearest, N(b.radius_m) + N(a.radius_m));
  value.away = unit(nearest.away);
  value.foot = b.center + Vec3::Zero();  // turns negative zeros of the foot into positive ones
  value.known = true;
  value.crisp = sharp(value.gap, kRefineDistance) && sharp_direction(nearest.away);
  return value;
}

}  // namespace

Contact contact(const Sphere& a, const Sphere& b) {
  const NearestValue nearest = WholeLadder::sharpened([&]<class N>() { return nearest_of_balls<N>(a, b); });
  return ball_contact(a, b.radius_m, nearest, -Vec3::UnitX());
}

Contact contact(const Sphere& a, const Box& b) {
  if (overlaps(Sphere{a.center, 0}, b).yes()) return contact_of_cores(Core(a), Core(b), true);
  return ball_contact(a, 0, nearest_value(a.center, a.radius_m, b), -Vec3::UnitX());
}

Contact contact(const Sphere& a, const Capsule& b) {
  return ball_contact(a, b.radius_m, nearest_value(a.center, a.radius_m, b), any_normal(Vec3(b.b - b.a)));
}

Contact contact(const Sphere& a, const Triangle& b) {
  const NearestValue nearest = nearest_value(a.center, a.radius_m, b);
  return ball_contact(a, 0, nearest, nearest.away.isZero(0) ? any_normal(b) : nearest.away);
}

Contact contact(const Box& a, const Box& b) { return contact_of_cores(Core(a), Core(b), true); }

Decision quick_contact(const Box& a, const Box& b, double off_m, Contact& found) {
  const BoxOverlap overlap = overlap_and_pushes_in_lanes(a, b, gap_bounds(off_m), kDepthError);
  if (overlap.decision != Decision::yes) return overlap.decision;
  const Core core_a(a);
  const Core core_b(b);
  found = at_unit_size(core_a, core_b, [&](const Core& own_a, const Core& own_b) {
    // Scaled copies need a new search of the axes.
    const bool is_known = &own_a == &core_a;
    return contact_of_meeting_cores(own_a, own_b, is_known ? std::optional(overlap.least_pushes) : std::nullopt);
  });
  return overlap.decision;
}

Contact contact(const Box& a, const Capsule& b) {
  const bool meet = overlaps(a, Capsule{b.a, b.b, 0}).yes();
  return contact_of_cores(Core(a), Core(b), meet);
}

Contact contact(const Box& a, const Triangle& b) { return contact_of_cores(Core(a), Core(b), true); }

Contact contact(const Capsule& a, const Capsule& b) {
  const bool meet = overlaps(Capsule{a.a, a.b, 0}, Capsule{b.a, b.b, 0}).yes();
  return contact_of_cores(Core(a), Core(b), meet);
}

Contact contact(const Capsule& a, const Triangle& b) {
  const bool meet = overlaps(Capsule{a.a, a.b, 0}, b).yes();
  return flipped(contact_of_cores(Core(b), Core(a), meet));
}

Contact contact(const Triangle& a, const Triangle& b) { return contact_of_cores(Core(a), Core(b), true); }

namespace {

template <class Shape>
/// Order of the kinds in the list of contacts.
constexpr int kRank = std::is_same_v<Shape, Sphere>    ? 0
                      : std::is_same_v<Shape, Box>     ? 1
                      : std::is_same_v<Shape, Capsule> ? 2
                                                       : 3;

}  // namespace

Contact contact(const Primitive& a, const Primitive& b) {
  return std::visit(
      [](const auto& first, const auto& second) {
        using First = std::decay_t<decltype(first)>;
        using Second = std::decay_t<decltype(second)>;
        if constexpr (kRank<First> <= kRank<Second> || General<First> || std::is_same_v<Second, HalfSpace>)
          return contact(first, second);
        else return flipped(contact(second, first));
      },
      a, b);
}

Contact contact(const Primitive& a, const Triangle& b) {
  return std::visit([&](const auto& solid) { return contact(solid, b); }, a);
}

}  // namespace collided::engine
