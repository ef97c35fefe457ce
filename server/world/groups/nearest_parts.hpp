#pragma once

#include "server/world/query/part_pairs.hpp"

namespace collided::engine {

/// The nearest parts of two objects so far, within a limit, and a lower bound on the distance of every tested pair of
/// parts.
struct NearestParts {
  double limit_m = 0;           // pairs certainly farther are ignored
  bool ends_at_overlap = true;  // a pair that may overlap ends the search
  bool may_overlap = false;
  Separation best = {.distance_m = std::numeric_limits<double>::infinity()};
  double low_m = std::numeric_limits<double>::infinity();
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;

  bool is_found() const { return best.distance_m < std::numeric_limits<double>::infinity(); }
  /// How near a part must be to matter.
  double reach_m() const;
  void take(const ConvexPart& a, std::uint32_t of_a, const ConvexPart& b, std::uint32_t of_b);
};

/// Searches for the nearest parts of two objects within nearest.limit_m. Each test shrinks the search.
void find_nearest_parts(const Placed& a, const Placed& b, NearestParts& nearest, WalkCost& cost, Deadline& deadline);

}  // namespace collided::engine
