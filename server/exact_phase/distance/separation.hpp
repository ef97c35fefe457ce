#pragma once

#include "server/geometry/vector.hpp"

namespace collided::engine {

/// The distance between two sets that do not overlap: |true distance - distance_m| <= error_m, bounded by two points
/// and a plane.
struct Separation {
  double distance_m = 0;
  double error_m = 0;
  Vec3 on_a = Vec3::Zero();  // within point_error_m of the set, not always of its nearest point
  Vec3 on_b = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // unit, from a to b
  double point_error_m = 0;
};

}  // namespace collided::engine
