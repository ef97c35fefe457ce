#pragma once

#include "server/geometry/tolerance.hpp"

namespace collided::engine {

/// The error bound of a length that is not exactly 0: if the length underflows, its own bound has lost some or all
/// digits.
constexpr double with_underflow(double length_m, double bound_m) {
  return length_m > 0 && length_m < kSmallestPlain ? bound_m + kUnderflow : bound_m;
}

}  // namespace collided::engine
