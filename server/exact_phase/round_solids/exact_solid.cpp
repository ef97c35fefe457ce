#include "server/exact_phase/round_solids/exact_solid.hpp"

#include "server/exact_phase/distance/polytope_kernel.hpp"

namespace collided::engine::kernel {

using Point = Vector<Dyadic>;
using Kind = ExactSolid::Kind;

Kind kind_of(const Convex& set) {
  if (set.plus == Convex::Plus::ellipsoid) return Kind::ellipsoid;
  if (set.disc_m > 0) return Kind::axial;
  if (set.ball_m == 0) return Kind::flat;
  return set.count() == 1 ? Kind::ball : Kind::capsule;
}

ExactSolid::ExactSolid(const Convex& set)
    : kind(kind_of(set)),
      points(corners_of(set)),
      radius(set.disc_m > 0 ? set.disc_m : set.ball_m),
      first_disc(set.disc_m > 0 ? set.first_disc : 0) {
  if (kind != Kind::ellipsoid) return;
  for (int i = 0; i < 3; ++i) half[i] = Dyadic(set.half_m[i]) * Point(Vec3(set.axes.col(i)));
}

ReachAlong<Dyadic> reach_along(const ExactSolid& set, const Point& n, const Point& origin) {
  const auto farthest = [&](std::size_t first, std::size_t end) {
    Dyadic most = dot(n, set.points[first] - origin);
    for (std::size_t i = first + 1; i < end; ++i) most = max(most, dot(n, set.points[i] - origin));
    return most;
  };
  const Dyadic one(1.0);
  const std::size_t first_disc = static_cast<std::size_t>(set.first_disc);
  ReachAlong<Dyadic> reach;
  ReachPart<Dyadic>& part = reach.part[reach.count++];
  part = {farthest(first_disc, set.points.size()), Dyadic(), one};
  if (set.kind == Kind::axial) {
    part.numerator = set.radius * set.radius * square(cross(n, set.axis()));
    part.denominator = square(set.axis());
    if (set.tapers()) reach.part[reach.count++] = {farthest(0, first_disc), Dyadic(), one};
    return reach;
  }
  part.numerator = set.radius * set.radius * square(n);
  for (int i = 0; set.kind == Kind::ellipsoid && i < 3; ++i) {
    const Dyadic extent = dot(n, set.half[i]);
    part.numerator = part.numerator + extent * extent;
  }
  return reach;
}

Decision parted_along(const Point& n, const ExactSolid& a, const ExactSolid& b) {
  const Point& origin = b.points[0];
  return parted(reach_along(a, n, origin), reach_along(b, -n, origin));
}

}  // namespace collided::engine::kernel
