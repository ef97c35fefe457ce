#include "server/exact_phase/round_solids/round_pair.hpp"

#include <cmath>

#include "server/exact_phase/distance/convex_pair.hpp"
#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/exact_phase/round_solids/axial_exact.hpp"
#include "server/exact_phase/round_solids/disc_exact.hpp"
#include "server/exact_phase/round_solids/ellipsoid_exact.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

using Point = Vector<Dyadic>;
using Kind = ExactSolid::Kind;

/// Distance of a point of the set from another one, with bounds that hold for the exact sets too.
struct NearestPoint {
  Vec3 place;
  double distance_m;
  double within_m;  // bound on the error of `place`, had it been formed without rounding
};

/// The point of one set nearest to another: moving a convex set by off_m moves it by at most the root of off_m times
/// the distance.
NearestPoint nearest(const RoundSet& set, const Convex& other, double other_off_m, bool on_other) {
  const Separation apart = separation_of({set.rounded, other});
  const double error_m = apart.error_m + 4 * (set.off_m + other_off_m);
  const double within_m = std::sqrt(apart.distance_m) * std::sqrt(error_m) + error_m + apart.point_error_m;
  return {on_other ? apart.on_b : apart.on_a, apart.distance_m, within_m};
}

/// True if the segment only leads away from the other set from this end on: the nearest point, known within a bound, is
/// certainly not ahead, because the distance from a convex set is convex along a line.
bool leads_away(const RoundSet& a, const RoundSet& segment, int from) {
  const Vec3& end = segment.rounded.carrier[from];
  const NearestPoint foot = nearest(a, Convex(Sphere{end, 0}), segment.off_m, false);
  // Same as in closest_in_general.
  const double within_m = 2 * foot.within_m + 2 * segment.off_m;
  const Vec3 displacement = segment.rounded.carrier[1 - from] - end;
  const Vec3 to_nearest = foot.place - end;
  const double slack = displacement.norm() * (2 * within_m + kBoundSlack * to_nearest.norm()) +
                       2 * segment.off_m * (to_nearest.norm() + within_m);
  return displacement.dot(to_nearest) + slack < 0;
}

/// Yes if the set's nearest point to the axis of a cylinder or capsule certainly lies between the axis' ends.
Decision is_beside(const RoundSet& set, const RoundSet& side) {
  const Vec3& begin = side.rounded.carrier[0];
  const Vec3& end = side.rounded.carrier[1];
  const NearestPoint foot = nearest(set, Convex(Capsule{begin, end, 0}), side.off_m, true);
  const Vec3 axis = end - begin;
  const double length = axis.norm();
  const double along = axis.dot(foot.place - begin) / length;
  // Same as in closest_in_general.
  const double within_m = 4 * foot.within_m + 8 * side.off_m + kBoundSlack * length;
  return along > within_m && along < length - within_m ? Decision::yes : Decision::undecided;
}

/// An ellipsoid that touches neither end but reaches into the infinite cylinder is wholly between the ends or beyond
/// one.
Decision ellipsoid_meets_side(const RoundSet& ellipsoid, const RoundSet& side) {
  const Decision endless = ellipsoid_meets_endless(ellipsoid.exact, side.exact);
  return endless == Decision::yes ? is_beside(ellipsoid, side) : endless;
}

const Point& apex_of(const ExactSolid& cone) { return cone.points[0]; }

Decision ellipsoid_meets_axial(const RoundSet& ellipsoid, const RoundSet& axial) {
  for (int end = axial.exact.first_disc; end < 2; ++end) {
    const Decision at_end = ellipsoid_meets_disc(ellipsoid.exact, axial.exact, end);
    if (at_end != Decision::no) return at_end;
  }
  if (!axial.exact.tapers()) return ellipsoid_meets_side(ellipsoid, axial);
  const bool at_apex = ellipsoid_meets_hull(ellipsoid.exact, {apex_of(axial.exact)}) == Decision::yes;
  return at_apex ? Decision::yes : Decision::undecided;
}

Convex disc_of(const Convex& cylinder, int end) {
  Convex disc = cylinder;
  disc.carrier[0] = cylinder.carrier[end];
  disc.carrier_count = 1;
  disc.reach_m = cylinder.disc_m;
  return disc;
}

/// A disc that meets no flat end of the other cylinder, decided as for an ellipsoid.
Decision disc_meets_side(const RoundSet& cylinder, int end, const RoundSet& side) {
  const Decision endless = disc_meets_endless(cylinder.exact, end, side.exact);
  if (endless != Decision::yes) return endless;
  return is_beside({cylinder.exact, disc_of(cylinder.rounded, end), cylinder.off_m}, side);
}

/// Two cylinders that share a point share one of a flat end, or one between the feet of their axes (sides_meet):
/// otherwise the common part of their infinite sides, which is connected, would lie within all four ends or cross one.
/// For cones, base and apex can prove contact; their sides are not tested.
Decision axials_meet(const RoundSet& a, const RoundSet& b) {
  AnyOf any;
  for (int end = a.exact.first_disc; end < 2; ++end) {
    for (int other = b.exact.first_disc; other < 2; ++other) {
      if (any.add(discs_meet(a.exact, end, b.exact, other))) return Decision::yes;
    }
  }
  const auto end_meets = [&](const RoundSet& one, const RoundSet& other) {
    for (int end = one.exact.first_disc; end < 2; ++end) {
      if (any.add(other.exact.tapers() ? Decision::undecided : disc_meets_side(one, end, other))) return true;
    }
    return one.exact.tapers() && any.add(axial_meets_ball(other.exact, apex_of(one.exact), Dyadic()));
  };
  if (end_meets(a, b) || end_meets(b, a)) return Decision::yes;
  return a.exact.tapers() || b.exact.tapers() ? Decision::undecided : any.result();
}

/// Tests a capsule whose end balls are separate from the cylinder.
Decision cylinder_meets_capsule_side(const RoundSet& cylinder, const RoundSet& capsule) {
  AnyOf any;
  for (int end = 0; end < 2; ++end) {
    if (any.add(disc_meets_side(cylinder, end, capsule))) return Decision::yes;
  }
  return any.result();
}

Decision meets_end_ball(const RoundSet& a, const ExactSolid& capsule, std::size_t end) {
  if (a.exact.kind == Kind::axial) return axial_meets_ball(a.exact, capsule.points[end], capsule.radius);
  ExactSolid ball;
  ball.kind = Kind::ball;
  ball.points = {capsule.points[end]};
  ball.radius = capsule.radius;
  return ellipsoids_meet(a.exact, ball);
}

/// Tests a capsule as its two end balls and its side.
Decision meets_capsule(const RoundSet& a, const RoundSet& capsule) {
  bool are_apart = true;
  for (std::size_t end = 0; end < 2; ++end) {
    const Decision at_end = meets_end_ball(a, capsule.exact, end);
    if (at_end == Decision::yes) return at_end;
    are_apart = are_apart && at_end == Decision::no;
  }
  if (are_apart && (leads_away(a, capsule, 0) || leads_away(a, capsule, 1))) return Decision::no;
  if (are_apart && a.exact.kind == Kind::ellipsoid) return ellipsoid_meets_side(a, capsule);
  const Decision sides = sides_meet(a.exact, capsule.exact);
  const bool ends_known = are_apart && a.exact.kind == Kind::axial && !a.exact.tapers();
  return sides == Decision::undecided && ends_known ? cylinder_meets_capsule_side(a, capsule) : sides;
}

/// Whether a plane along a flat end separates the two.
bool end_parts(const ExactSolid& axial, const ExactSolid& other) {
  const Point axis = axial.axis();
  return parted_along(axis, axial, other) == Decision::yes || parted_along(-axis, axial, other) == Decision::yes;
}

Decision meets_ellipsoid(const RoundSet& a, const RoundSet& ellipsoid) {
  switch (a.exact.kind) {
    case Kind::flat: return ellipsoid_meets_hull(ellipsoid.exact, a.exact.points);
    case Kind::capsule: return meets_capsule(ellipsoid, a);
    case Kind::axial: return ellipsoid_meets_axial(ellipsoid, a);
    default: return ellipsoids_meet(a.exact, ellipsoid.exact);
  }
}

Decision axials_meet_in_order(const RoundSet& a, const RoundSet& b) {
  const Decision parallel = parallel_axials_meet(a.exact, b.exact);
  if (parallel != Decision::undecided) return parallel;
  const Decision sides = sides_meet(a.exact, b.exact);
  return sides == Decision::undecided ? axials_meet(a, b) : sides;
}

/// True if a's kind is not behind b's.
Decision in_order(const RoundSet& a, const RoundSet& b) {
  if (a.exact.kind >= Kind::capsule) {
    if (a.exact.kind == Kind::axial && end_parts(a.exact, b.exact)) return Decision::no;
    if (b.exact.kind == Kind::axial && end_parts(b.exact, a.exact)) return Decision::no;
  }
  if (b.exact.kind == Kind::ellipsoid) return meets_ellipsoid(a, b);
  switch (a.exact.kind) {
    case Kind::flat: return axial_meets_border(b.exact, a.exact);
    case Kind::ball: return axial_meets_ball(b.exact, a.exact.points[0], a.exact.radius);
    case Kind::capsule: return meets_capsule(b, a);
    default: return axials_meet_in_order(a, b);
  }
}

}  // namespace

Decision round_sets_meet(const RoundSet& a, const RoundSet& b) {
  return a.exact.kind <= b.exact.kind ? in_order(a, b) : in_order(b, a);
}

ExactResult round_sets_meet(const Convex& a, const Convex& b) {
  // The ladder from double upward decides most of these, and needs no copy in rationals.
  if (kind_of(a) == Kind::flat && kind_of(b) == Kind::axial) return axial_meets_flat(b, a);
  if (kind_of(b) == Kind::flat && kind_of(a) == Kind::axial) return axial_meets_flat(a, b);
  return {round_sets_meet(RoundSet{ExactSolid(a), a}, RoundSet{ExactSolid(b), b}), Level::rational};
}

Decision holds_point(const ExactSolid& set, const Point& point) {
  if (set.kind == Kind::axial) return axial_meets_ball(set, point, Dyadic());
  if (set.kind == Kind::ellipsoid) return ellipsoid_meets_hull(set, {point});
  return hulls_meet(set.points, {point}, set.radius);
}

}  // namespace collided::engine::kernel
