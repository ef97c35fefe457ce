#pragma once

#include <optional>

#include "server/world/objects/contact_search.hpp"
#include "server/world/query/pair_report.hpp"

namespace collided::engine {

/// How near two objects are, or how deep in each other.
struct ObjectClearance {
  Decision touches = Decision::no;
  // For yes: one lies wholly within the other, which is solid, and their surfaces do not meet.
  Contained contained = Contained::none;
  // Their distance; where they touch less the depth of the deepest pair of parts; where one is within a solid less the
  // distance of the surfaces. |truth - clearance_m| <= error_m.
  double clearance_m = 0;
  double error_m = 0;
  Vec3 on_a =
      Vec3::Zero();  // nearest points, within point_error_m; where surfaces meet both in the middle of the overlap
  Vec3 on_b = Vec3::Zero();
  double point_error_m = 0;
  Vec3 normal = Vec3::Zero();  // unit, from a to b
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;

  double low_m() const { return clearance_m - error_m; }
  double high_m() const { return clearance_m + error_m; }
};

/// What of a clearance matters to whoever asks.
struct ClearanceWanted {
  double limit_m = 0;  // not where it is surely larger
  bool depth = true;   // else of objects that touch only that they do
};

/// The clearance of two objects, nothing where it is surely above the limit. Where the deadline ends it, what it returns
/// is wrong.
///
/// cost  a search for the nearest parts within the limit, and the exact test only where that leaves open whether they
///       touch
std::optional<ObjectClearance> clearance_between(const Placed& a, const Placed& b, const ClearanceWanted& wanted,
                                                 WalkCost& cost, Deadline& deadline);

}  // namespace collided::engine
