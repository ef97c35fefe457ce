#include "server/exact_phase/round_solids/round_pair.hpp"

#include <cmath>

#include "server/exact_phase/distance/convex_pair.hpp"
#include "server/exact_phase/round_solids/axial_exact.hpp"
#include "server/exact_phase/round_solids/disc_exact.hpp"
#include "server/exact_phase/round_solids/ellipsoid_exact.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

/// In the order in which in_order() takes pairs.
enum class SolidKind { flat, ball, capsule, axial, ellipsoid };

SolidKind kind_of(const Convex& set) {
  if (set.plus == Convex::Plus::ellipsoid) return SolidKind::ellipsoid;
  if (set.disc_m > 0) return SolidKind::axial;
  if (set.ball_m == 0) return SolidKind::flat;
  return set.count() == 1 ? SolidKind::ball : SolidKind::capsule;
}

ExactResult by_rationals(Decision decision) { return {decision, Level::rational}; }

Convex ball_at(const Vec3& center, double radius_m) { return Convex(Sphere{center, radius_m}); }

/// Whether the segment only leads away from the other set from this end on: true where the nearest point, known within
/// a bound, is surely not ahead, because the distance from a convex set is convex along a line.
bool leads_away(const Convex& a, const Vec3& end, const Vec3& other_end) {
  const Separation apart = separation_of({a, Convex(Sphere{end, 0})});
  // As in closest_in_general.
  const double within_m =
      2 * std::sqrt(apart.distance_m) * std::sqrt(apart.error_m) + apart.error_m + apart.point_error_m;
  const Vec3 displacement = other_end - end;
  const Vec3 to_nearest = apart.on_a - end;
  return displacement.dot(to_nearest) + displacement.norm() * (2 * within_m + kBoundSlack * to_nearest.norm()) < 0;
}

/// Yes: the set's nearest point to the axis of a cylinder or capsule lies surely between the axis' ends.
Decision is_beside(const Convex& set, const Convex& side) {
  const Separation apart = separation_of({set, Convex(Capsule{side.carrier[0], side.carrier[1], 0})});
  const Vec3 axis = side.carrier[1] - side.carrier[0];
  const double length = axis.norm();
  const double along = axis.dot(apart.on_b - side.carrier[0]) / length;
  // As in closest_in_general.
  const double within_m =
      4 * (std::sqrt(apart.distance_m) * std::sqrt(apart.error_m) + apart.error_m + apart.point_error_m) +
      kBoundSlack * length;
  if (along > within_m && along < length - within_m) return Decision::yes;
  return Decision::undecided;
}

/// An ellipsoid that touches neither end but reaches into the infinite cylinder is wholly between the ends or beyond
/// one.
ExactResult ellipsoid_meets_side(const Convex& ellipsoid, const Convex& side) {
  const Decision endless = ellipsoid_meets_endless(ellipsoid, side);
  if (endless != Decision::yes) return by_rationals(endless);
  return by_rationals(is_beside(ellipsoid, side));
}

bool tapers(const Convex& axial) { return axial.first_disc > 0; }

/// The apex of a cone as a point: tests of its base leave it out.
Convex apex_of(const Convex& cone) { return Convex(Sphere{cone.carrier[0], 0}); }

ExactResult ellipsoid_meets_axial(const Convex& ellipsoid, const Convex& axial) {
  for (int end = axial.first_disc; end < 2; ++end) {
    const Decision at_end = ellipsoid_meets_disc(ellipsoid, axial, end);
    if (at_end != Decision::no) return by_rationals(at_end);
  }
  if (!tapers(axial)) return ellipsoid_meets_side(ellipsoid, axial);
  const bool at_apex = ellipsoid_meets_flat(ellipsoid, apex_of(axial)) == Decision::yes;
  return by_rationals(at_apex ? Decision::yes : Decision::undecided);
}

Convex disc_of(const Convex& cylinder, int end) {
  Convex disc = cylinder;
  disc.carrier[0] = cylinder.carrier[end];
  disc.carrier_count = 1;
  disc.reach_m = cylinder.disc_m;
  return disc;
}

/// A disc that meets no flat end of the other cylinder: as for an ellipsoid.
Decision disc_meets_side(const Convex& cylinder, int end, const Convex& side) {
  const Decision endless = disc_meets_endless(cylinder, end, side);
  return endless == Decision::yes ? is_beside(disc_of(cylinder, end), side) : endless;
}

/// Two cylinders that share a point share one of a flat end, or one between the feet of their axes (sides_meet):
/// otherwise what their infinite sides share, which is connected, would lie within all four ends or cross one. For
/// cones, base and apex can say yes; their sides are not tested.
Decision axials_meet(const Convex& a, const Convex& b) {
  AnyOf any;
  for (int end = a.first_disc; end < 2; ++end) {
    for (int other = b.first_disc; other < 2; ++other) {
      if (any.add(discs_meet(a, end, b, other))) return Decision::yes;
    }
  }
  const auto end_meets = [&](const Convex& one, const Convex& other) {
    for (int end = one.first_disc; end < 2; ++end) {
      if (any.add(tapers(other) ? Decision::undecided : disc_meets_side(one, end, other))) return true;
    }
    return tapers(one) && any.add(axial_meets_flat(other, apex_of(one)).decision);
  };
  if (end_meets(a, b) || end_meets(b, a)) return Decision::yes;
  return tapers(a) || tapers(b) ? Decision::undecided : any.result();
}

/// The same for a capsule whose end balls are separate from the cylinder.
Decision cylinder_meets_capsule_side(const Convex& cylinder, const Convex& capsule) {
  AnyOf any;
  for (int end = 0; end < 2; ++end) {
    if (any.add(disc_meets_side(cylinder, end, capsule))) return Decision::yes;
  }
  return any.result();
}

/// Tests a capsule as its two end balls and its side.
ExactResult meets_capsule(const Convex& a, const Convex& capsule) {
  bool are_apart = true;
  for (int end = 0; end < 2; ++end) {
    const ExactResult at_end = round_sets_meet(a, ball_at(capsule.carrier[end], capsule.ball_m));
    if (at_end.yes()) return at_end;
    are_apart = are_apart && at_end.decision == Decision::no;
  }
  const Vec3& first = capsule.carrier[0];
  const Vec3& second = capsule.carrier[1];
  if (are_apart && (leads_away(a, first, second) || leads_away(a, second, first))) return by_rationals(Decision::no);
  if (are_apart && kind_of(a) == SolidKind::ellipsoid) return ellipsoid_meets_side(a, capsule);
  const Decision sides = sides_meet(a, capsule);
  const bool ends_known = are_apart && kind_of(a) == SolidKind::axial && !tapers(a);
  return by_rationals(sides == Decision::undecided && ends_known ? cylinder_meets_capsule_side(a, capsule) : sides);
}

/// Whether a plane along a flat end separates the two.
bool end_parts(const Convex& axial, const Convex& other) {
  const Vector<Dyadic> axis = Vector<Dyadic>(axial.carrier[1]) - Vector<Dyadic>(axial.carrier[0]);
  return parted_along(axis, axial, other) == Decision::yes || parted_along(-axis, axial, other) == Decision::yes;
}

ExactResult in_order(const Convex& a, SolidKind kind_a, const Convex& b, SolidKind kind_b) {
  if (kind_a >= SolidKind::capsule && (kind_a == SolidKind::axial || kind_b == SolidKind::axial)) {
    if (kind_a == SolidKind::axial && end_parts(a, b)) return by_rationals(Decision::no);
    if (kind_b == SolidKind::axial && end_parts(b, a)) return by_rationals(Decision::no);
  }
  if (kind_b == SolidKind::ellipsoid) {
    if (kind_a == SolidKind::flat) return by_rationals(ellipsoid_meets_flat(b, a));
    if (kind_a == SolidKind::capsule) return meets_capsule(b, a);
    if (kind_a == SolidKind::axial) return ellipsoid_meets_axial(b, a);
    return by_rationals(ellipsoids_meet(a, b));
  }
  if (kind_a == SolidKind::flat) return axial_meets_flat(b, a);
  if (kind_a == SolidKind::ball) return by_rationals(axial_meets_ball(b, a.carrier[0], a.ball_m));
  if (kind_a == SolidKind::capsule) return meets_capsule(b, a);
  const Decision parallel = parallel_axials_meet(a, b);
  if (parallel != Decision::undecided) return by_rationals(parallel);
  const Decision sides = sides_meet(a, b);
  return by_rationals(sides == Decision::undecided ? axials_meet(a, b) : sides);
}

}  // namespace

ExactResult round_sets_meet(const Convex& a, const Convex& b) {
  const SolidKind kind_a = kind_of(a);
  const SolidKind kind_b = kind_of(b);
  return kind_a <= kind_b ? in_order(a, kind_a, b, kind_b) : in_order(b, kind_b, a, kind_a);
}

}  // namespace collided::engine::kernel
