#pragma once

#include <algorithm>
#include <limits>

#include "server/exact_phase/arithmetic/number.hpp"

namespace collided::engine::kernel {

/// The largest double at or below a number >= 0.
inline double rounded_down(const Dyadic& x) {
  const auto [fraction, power] = x.split();
  const double rounded = std::ldexp(fraction, static_cast<int>(std::clamp(power, -4000L, 4000L)));
  if (!std::isfinite(rounded)) return std::numeric_limits<double>::max();
  // split() truncates toward zero, but ldexp rounds to nearest among the denormals.
  return sign(Dyadic(rounded) - x) == Sign::positive ? std::nextafter(rounded, 0.0) : rounded;
}

/// The smallest double at or above a number >= 0; infinite above the largest.
inline double rounded_up(const Dyadic& x) {
  const double below = rounded_down(x);
  return sign(x - Dyadic(below)) == Sign::positive ? std::nextafter(below, std::numeric_limits<double>::infinity())
                                                   : below;
}

}  // namespace collided::engine::kernel
