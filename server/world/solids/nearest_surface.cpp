#include "server/world/solids/nearest_surface.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/distance/closest.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/scene_touch.hpp"

namespace collided::engine {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// How far the box reaches along a direction.
double reach_along(const Aabb& box, const Vec3& direction) {
  return (direction.array() > 0).select(box.high, box.low).dot(direction);
}

}  // namespace

std::optional<NearestSurface> nearest_surface(const IndexedMesh& surface, const Placed& object, const Vec3& point,
                                              Deadline& deadline, WalkCost& cost, std::uint32_t& tests) {
  NearestSurface best{.distance_m = kUnbounded};
  double limit_m2 = kUnbounded;
  const auto candidate = [&](std::uint32_t number, double) {
    if (deadline.is_over()) return -1.0;
    const Triangle own = surface.mesh->triangle(number);
    const Closest found = closest(point, place(object.frame, own));
    ++tests;
    const bool is_nearer =
        found.distance_m < best.distance_m || (found.distance_m == best.distance_m && number < best.triangle);
    if (!is_nearer) return limit_m2;
    best = {.distance_m = found.distance_m,
            .error_m = found.distance_error_m + placing_error_m(object.frame, own),
            .triangle = number,
            .point = found.point,
            .normal = -found.normal};
    limit_m2 = square_up(best.distance_m + best.error_m);
    return limit_m2;
  };
  const Vec3 away = point - object.frame.position;
  const double slack_m = placement_slack(object.frame, away.lpNorm<1>() + point.lpNorm<1>(), surface.radius_m);
  surface.tree.walk_near(object.frame.rotation.transpose() * away, limit_m2, slack_m, candidate, cost);
  if (deadline.was_over() || best.triangle == kNoTriangle) return std::nullopt;
  return best;
}

std::optional<NearestSurface> nearest_surface(const SolidMesh& solid, const Placed& object, const Vec3& point,
                                              Deadline& deadline, WalkCost& cost, std::uint32_t& tests) {
  std::optional<NearestSurface> best = nearest_surface(*solid.surface, object, point, deadline, cost, tests);
  if (best && !solid.is_border) best->error_m = kUnbounded;
  return best;
}

WayOut way_out(const SolidMesh& solid, const Placed& object, const NearestSurface& nearest, double inscribed_m,
               const Aabb& inner) {
  WayOut way{.least_m = 0, .most_m = kUnbounded};
  // An object that leaves the solid takes the ball along: its centre to the surface, and then its radius beyond.
  if (std::isfinite(nearest.error_m))
    way.least_m = std::max(0.0, nearest.distance_m - nearest.error_m - kUnderflow + inscribed_m) * (1 - kChainSlack);
  const Aabb& own = solid.surface->tree.bounds();
  const double far_m =
      object.frame.position.lpNorm<1>() + solid.surface->radius_m + inner.low.lpNorm<1>() + inner.high.lpNorm<1>();
  const double slack_m = placement_slack(object.frame, far_m, solid.surface->radius_m);
  const auto look_along = [&](const Vec3& direction) {
    const double solid_m =
        reach_along(own, object.frame.rotation.transpose() * direction) + object.frame.position.dot(direction);
    const double least_m = -reach_along(inner, -direction);
    way.most_m = std::min(way.most_m, (solid_m - least_m + slack_m) * (1 + kChainSlack));
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      look_along(sign * Vec3::Unit(axis));
      look_along(sign * object.frame.rotation.col(axis));
    }
  }
  if (!nearest.normal.isZero(0)) look_along(nearest.normal);
  return way;
}

Contact contact_inside(const NearestSurface& nearest, const WayOut& way) {
  // The nearest way out continues beyond the surface, and a contact's normal points the other way, to the solid.
  return {.point = nearest.point,
          .normal = nearest.normal.isZero(0) ? Vec3(-Vec3::UnitZ()) : Vec3(-nearest.normal),
          .depth_m = way.least_m,
          .depth_error_m = way.most_m - way.least_m};
}

}  // namespace collided::engine
