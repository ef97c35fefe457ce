#include "server/exact_phase/contact.hpp"

#include <algorithm>
#include <variant>

#include "server/exact_phase/core.hpp"
#include "server/exact_phase/nearest_value.hpp"
#include "server/exact_phase/overlap.hpp"

namespace collided {
namespace {

using namespace kernel;

Contact flipped(Contact c) {
  c.normal = -c.normal;
  return c;
}

Contact make_contact(const Vec3& point, const Vec3& normal, const Bounded& depth) {
  // Cores that touch in exact arithmetic may come out a rounding below zero.
  const double depth_m = std::max(depth.value, 0.0);
  return {point, normal, depth_m, depth.bound() + std::abs(depth_m - depth.value)};
}

/// Half the least push, from the surface of a core's rounding towards the other.
Vec3 middle_along(const Vec3& on_a, double radius_a_m, const Vec3& normal, double depth_m) {
  return on_a + (radius_a_m - depth_m / 2) * normal;
}

/// The sphere's centre is outside the core of `other` or on it: the depth is the radii less the distance.
Contact ball_contact(const Sphere& a, double other_radius_m, const NearestValue& nearest, const Vec3& fallback) {
  const Vec3 towards = nearest.away.isZero(0) ? fallback : nearest.away;
  const Vec3 normal = -towards;
  const Contact contact = make_contact(a.center, normal, -nearest.gap);
  // Seen from b: its surface, half the depth inward.
  return {middle_along(nearest.foot, other_radius_m, towards, contact.depth_m), normal, contact.depth_m,
          contact.depth_error_m};
}

/// The push along one facet axis, in the direction that needs less.
struct Push {
  Bounded depth;
  Vec3 normal = Vec3::Zero();
  bool exists = false;
};

template <class N>
Push push_out(const FacetAxis& axis, const Core& a, const Core& b) {
  const Vector<N> n = direction<N>(axis);
  if (is_zero(n) == Decision::yes) return {};
  const Scaled length = sqrt(scaled(square(n)));
  const Bounded forward = plain(scaled(push_along(n, a, b)) / length);
  const Bounded backward = plain(scaled(push_along(-n, a, b)) / length);
  const Vec3 normal = unit(n);
  return backward.value < forward.value ? Push{backward, -normal, true} : Push{forward, normal, true};
}

/// Least push that parts two cores that share a point: the nearest facet of the Minkowski difference. It is flat, and
/// the push zero, when all facet axes vanish.
Push least_push(const Core& a, const Core& b) {
  const FacetAxes axes = facet_axes(a, b);
  Push least;
  for (int i = 0; i < axes.count; ++i) {
    Push push = push_out<Bounded>(axes.axis[i], a, b);
    if (!push.exists) continue;
    // A poorly known axis is worth an exact evaluation only if it may win.
    const bool may_win = !least.exists || !(push.depth.low() > least.depth.high());
    if (may_win && !sharp(push.depth, kRefineDistance)) push = push_out<Dyadic>(axes.axis[i], a, b);
    if (!push.exists) continue;
    // Equal depths keep the earlier axis: faces before edge pairs, in a fixed order.
    const bool wins = !least.exists || push.depth.value < least.depth.value * (1 - kRefineDistance);
    const Bounded depth = least.exists ? lesser(least.depth, push.depth) : push.depth;
    if (wins) least = push;
    least.depth = depth;
  }
  return least;
}

Vec3 edge_normal(const Core& core) { return any_normal(Vec3(core.point[1] - core.point[0])); }

Vec3 normal_without_facets(const Core& a, const Core& b) {
  if (a.point_count == 3) return any_normal(Triangle{a.point[0], a.point[1], a.point[2]});
  if (b.point_count == 3) return any_normal(Triangle{b.point[0], b.point[1], b.point[2]});
  if (a.point_count == 2 && a.point[0] != a.point[1]) return edge_normal(a);
  return b.point_count == 2 ? edge_normal(b) : Vec3(Vec3::UnitX());
}

Contact contact_of_meeting_cores(const Core& a, const Core& b) {
  Push push = least_push(a, b);
  if (!push.exists) push = {Bounded(), normal_without_facets(a, b), true};
  const Bounded depth = push.depth + Bounded(a.radius_m) + Bounded(b.radius_m);
  return make_contact(middle_of_both(a, b, push.normal), push.normal, depth);
}

/// Cores apart, radii overlapping. Two witnesses bound the distance from above, the plane across them from below, and
/// both bounds hold whatever the witnesses are worth.
Contact contact_of_apart_cores(const Core& a, const Core& b) {
  const WitnessPair pair = nearest_witnesses(a, b);
  const Vec3 normal = unit(Vec3(pair.on_b - pair.on_a));
  const double apart_m = (pair.on_b - pair.on_a).stableNorm();
  // The witnesses are off their cores by roundings of the extents, the norm by roundings of itself.
  const Bounded apart(apart_m, kWitnessError * (extent(a) + extent(b)) + 16 * kRoundoff * apart_m);
  const Bounded radii = Bounded(a.radius_m) + Bounded(b.radius_m);
  const Bounded least = radii - apart;
  Bounded most = radii;
  Vec3 chosen = normal;
  if (!normal.isZero(0)) {
    const Vector<Bounded> n(normal);
    most = radii + push_along(n, a, b) / sqrt(square(n));
  }
  const double low = std::max(least.low(), 0.0);
  const double high = std::max(most.high(), low);
  const double middle = low + (high - low) / 2;
  if (chosen.isZero(0)) chosen = normal_without_facets(a, b);
  const Bounded depth(middle, (high - low) / 2 + 2 * kRoundoff * high);
  return make_contact(middle_along(pair.on_a, a.radius_m, chosen, middle), chosen, depth);
}

}  // namespace

Contact contact(const Sphere& a, const Sphere& b) {
  return ball_contact(a, b.radius_m, nearest_value(a.center, a.radius_m, b), -Vec3::UnitX());
}

Contact contact(const Sphere& a, const Box& b) {
  if (overlaps(Sphere{a.center, 0}, b).yes()) return contact_of_meeting_cores(Core(a), Core(b));
  return ball_contact(a, 0, nearest_value(a.center, a.radius_m, b), -Vec3::UnitX());
}

Contact contact(const Sphere& a, const Capsule& b) {
  return ball_contact(a, b.radius_m, nearest_value(a.center, a.radius_m, b), any_normal(Vec3(b.b - b.a)));
}

Contact contact(const Sphere& a, const Triangle& b) {
  return ball_contact(a, 0, nearest_value(a.center, a.radius_m, b), any_normal(b));
}

Contact contact(const Box& a, const Box& b) { return contact_of_meeting_cores(Core(a), Core(b)); }

Contact contact(const Box& a, const Capsule& b) {
  const bool meet = overlaps(a, Capsule{b.a, b.b, 0}).yes();
  return meet ? contact_of_meeting_cores(Core(a), Core(b)) : contact_of_apart_cores(Core(a), Core(b));
}

Contact contact(const Box& a, const Triangle& b) { return contact_of_meeting_cores(Core(a), Core(b)); }

Contact contact(const Capsule& a, const Capsule& b) {
  const bool meet = overlaps(Capsule{a.a, a.b, 0}, Capsule{b.a, b.b, 0}).yes();
  return meet ? contact_of_meeting_cores(Core(a), Core(b)) : contact_of_apart_cores(Core(a), Core(b));
}

Contact contact(const Capsule& a, const Triangle& b) {
  const bool meet = overlaps(Capsule{a.a, a.b, 0}, b).yes();
  return flipped(meet ? contact_of_meeting_cores(Core(b), Core(a)) : contact_of_apart_cores(Core(b), Core(a)));
}

Contact contact(const Triangle& a, const Triangle& b) { return contact_of_meeting_cores(Core(a), Core(b)); }

namespace {

template <class Shape>
constexpr int kRank = std::is_same_v<Shape, Sphere> ? 0 : std::is_same_v<Shape, Box> ? 1 : 2;

}  // namespace

Contact contact(const Primitive& a, const Primitive& b) {
  return std::visit(
      [](const auto& first, const auto& second) {
        using First = std::decay_t<decltype(first)>;
        using Second = std::decay_t<decltype(second)>;
        if constexpr (kRank<First> <= kRank<Second>) return contact(first, second);
        else return flipped(contact(second, first));
      },
      a, b);
}

Contact contact(const Primitive& a, const Triangle& b) {
  return std::visit([&](const auto& solid) { return contact(solid, b); }, a);
}

}  // namespace collided
