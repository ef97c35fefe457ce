#pragma once

#include <limits>

#include "server/geometry/vector.hpp"

namespace collided::engine {

/// The points origin + s * direction with s >= 0 and s * |direction| <= length_m.
///
/// direction  finite and non-zero, any length
/// length_m   in [0, inf], metres
struct Ray {
  Vec3 origin;
  Vec3 direction;
  double length_m = std::numeric_limits<double>::infinity();
};

}  // namespace collided::engine
