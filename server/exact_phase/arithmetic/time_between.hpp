#pragma once

#include <bit>
#include <cstdint>

namespace collided::engine::kernel {

/// A time strictly between, if there is one: the middle if the two are close, by exponent if they are far apart, so
/// that a contact at 1e-300 takes as few steps as one at 0.5.
inline double time_between(double low, double high) {
  if (high <= 2 * low) return low + (high - low) / 2;
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  return std::bit_cast<double>(bits(low) + (bits(high) - bits(low)) / 2);
}

}  // namespace collided::engine::kernel
