#pragma once

#include <cmath>

#include "server/geometry/tolerance.hpp"
#include "server/geometry/vector.hpp"

namespace collided::engine {

/// The length of a vector whose square may be out of range. Avoids scaling, which costs several times as much, if the
/// square is far from both ends of the range. Within 3 units of roundoff of the true length, 6 if it scales.
inline double stable_length(const Vec3& v) {
  const double square = v.squaredNorm();
  return square > kSmallestPlain && square < kLargestPlain ? std::sqrt(square) : v.stableNorm();
}

}  // namespace collided::engine
