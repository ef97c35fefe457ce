#include "server/world/groups/object_clearance.hpp"

#include <limits>

#include "server/geometry/tolerance.hpp"
#include "server/world/groups/nearest_parts.hpp"
#include "server/world/objects/object_placing.hpp"
#include "server/world/query/underflow.hpp"

namespace collided::engine {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

ObjectClearance of_contact(const ContactSearch& touch, const Placed& a, const Placed& b) {
  const double placing_m = placing_error_m(a, touch.a_triangle, b, touch.b_triangle);
  return {.touches = Decision::yes,
          .clearance_m = -touch.contact.depth_m,
          .error_m = touch.contact.depth_error_m + placing_m,
          .on_a = touch.contact.point,
          .on_b = touch.contact.point,
          .point_error_m = kEndless,
          .normal = touch.contact.normal,
          .a_triangle = touch.a_triangle,
          .b_triangle = touch.b_triangle};
}

/// The truly nearest parts may be any whose interval begins below the best ones'.
ObjectClearance of_distance(const NearestParts& nearest, double placing_m) {
  const Separation& best = nearest.best;
  const double error_m = std::max(best.error_m, best.distance_m - std::max(nearest.low_m, 0.0));
  const double apart_m = std::max(best.distance_m, std::numeric_limits<double>::denorm_min());
  return {.clearance_m = best.distance_m,
          .error_m = with_underflow(apart_m, error_m) + placing_m,
          .on_a = best.on_a,
          .on_b = best.on_b,
          .point_error_m = best.point_error_m + placing_m,
          .normal = best.normal,
          .a_triangle = nearest.a_triangle,
          .b_triangle = nearest.b_triangle};
}

ObjectClearance undecided_between(const NearestParts& nearest, double placing_m) {
  ObjectClearance doubtful =
      nearest.is_found() ? of_distance(nearest, placing_m) : ObjectClearance{.error_m = kEndless};
  doubtful.touches = Decision::undecided;
  return doubtful;
}

NearestParts nearest_within(const Placed& a, const Placed& b, double limit_m, bool ends_at_overlap, WalkCost& cost,
                            Deadline& deadline) {
  NearestParts nearest{.limit_m = limit_m, .ends_at_overlap = ends_at_overlap};
  find_nearest_parts(a, b, nearest, cost, deadline);
  return nearest;
}

/// For one object within the other, a solid: the distance of their surfaces, negative because inside.
std::optional<ObjectClearance> within_solid(const Placed& a, const Placed& b, WalkCost& cost, Deadline& deadline) {
  if (!a.info->rare->solid && !b.info->rare->solid) return std::nullopt;
  const Contained contained = containment(a, b, deadline);
  const Placed& outer = contained == Contained::a_in_b ? b : a;
  if (contained == Contained::none || !outer.info->rare->solid) return std::nullopt;
  const NearestParts nearest = nearest_within(a, b, kEndless, false, cost, deadline);
  ObjectClearance inside = of_distance(nearest, placing_error_m(a, kNoTriangle, b, kNoTriangle));
  inside.touches = Decision::yes;
  inside.contained = contained;
  inside.clearance_m = -inside.clearance_m;
  return inside;
}

std::optional<ObjectClearance> within_limit(const ObjectClearance& found, double limit_m) {
  if (found.low_m() > limit_m) return std::nullopt;
  return found;
}

}  // namespace

/// The search for the nearest parts comes first: usually it shows that the two are apart, and the exact test over all
/// parts that may touch is not needed.
std::optional<ObjectClearance> clearance_between(const Placed& a, const Placed& b, const ClearanceWanted& wanted,
                                                 WalkCost& cost, Deadline& deadline) {
  const bool may_meet_at_all = overlaps(a.bounds, b.bounds);
  if (!may_meet_at_all && wanted.limit_m <= 0) return std::nullopt;
  const double placing_m = placing_error_m(a, kNoTriangle, b, kNoTriangle);
  NearestParts nearest;
  if (wanted.limit_m > placing_m) nearest = nearest_within(a, b, wanted.limit_m, may_meet_at_all, cost, deadline);
  if (deadline.was_over()) return std::nullopt;
  const bool is_apart = !may_meet_at_all || (wanted.limit_m > placing_m && !nearest.may_overlap &&
                                             (!nearest.is_found() || nearest.low_m > placing_m));
  if (!is_apart) {
    ContactSearch touch;
    touch.wanted = wanted.depth;
    touch.deadline = &deadline;
    search_objects(a, b, touch, cost);
    if (touch.yes && wanted.depth) return within_limit(of_contact(touch, a, b), wanted.limit_m);
    if (touch.yes) return ObjectClearance{.touches = Decision::yes, .error_m = kEndless};
    // They may overlap only as placed: the numbers below need the search without that end.
    nearest = nearest_within(a, b, std::max(wanted.limit_m, placing_m), false, cost, deadline);
    if (touch.undecided) return undecided_between(nearest, placing_m);
  }
  if (may_meet_at_all) {
    if (const auto inside = within_solid(a, b, cost, deadline)) return within_limit(*inside, wanted.limit_m);
  }
  if (!nearest.is_found()) return std::nullopt;
  return within_limit(of_distance(nearest, placing_m), wanted.limit_m);
}

}  // namespace collided::engine
