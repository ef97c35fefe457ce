#pragma once

#include <optional>

#include "server/world/objects/contact_search.hpp"
#include "server/world/query/pair_report.hpp"

namespace collided::engine {

/// The distance of two objects, or their depth in each other.
struct ObjectClearance {
  Decision touches = Decision::no;
  // If they touch: one lies wholly within the other, which is solid, and their surfaces do not meet.
  Contained contained = Contained::none;
  // Their distance; if they touch, minus the depth of the deepest pair of parts; if one is within a solid, minus the
  // distance of the surfaces. |truth - clearance_m| <= error_m.
  double clearance_m = 0;
  double error_m = 0;
  Vec3 on_a =
      Vec3::Zero();  // nearest points, within point_error_m; if surfaces meet, both in the middle of the overlap
  Vec3 on_b = Vec3::Zero();
  double point_error_m = 0;
  Vec3 normal = Vec3::Zero();  // unit, from a to b
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;

  double low_m() const { return clearance_m - error_m; }
  double high_m() const { return clearance_m + error_m; }
};

/// What the caller needs of a clearance.
struct ClearanceWanted {
  double limit_m = 0;  // none if it is certainly larger
  bool depth = true;   // false: for objects that touch, only the fact
};

/// The clearance of two objects; nothing if it is certainly above the limit. If the deadline ends it, the result is
/// wrong.
///
/// cost  a search for the nearest parts within the limit, and the exact test only if that leaves open whether they
///       touch
std::optional<ObjectClearance> clearance_between(const Placed& a, const Placed& b, const ClearanceWanted& wanted,
                                                 WalkCost& cost, Deadline& deadline);

}  // namespace collided::engine
