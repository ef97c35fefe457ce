#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "collided/questions.hpp"

namespace collided::testing_support {

inline std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

/// Bit for bit, but for numbers of objects, which each server draws for itself.
inline bool are_equal(const Hit& a, const Hit& b) {
  return a.object == b.object && a.triangle == b.triangle && bits(a.distance_m) == bits(b.distance_m) &&
         bits(a.error_m) == bits(b.error_m) && bits(a.exit_m) == bits(b.exit_m) && a.point == b.point &&
         a.normal == b.normal && a.inside == b.inside;
}

inline bool are_equal(const Answer& a, const Answer& b) {
  return a.verdict == b.verdict && a.reason == b.reason &&
         std::ranges::equal(a.hits, b.hits, [](const Hit& one, const Hit& other) { return are_equal(one, other); });
}

}  // namespace collided::testing_support
