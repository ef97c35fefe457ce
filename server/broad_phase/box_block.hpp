#pragma once

#include <cstdint>

#include "server/geometry/aabb.hpp"

namespace collided::engine {

/// Eight boxes stored axis by axis, so that six SIMD comparisons compare one box with all of them. An unused lane is
/// NaN, which overlaps nothing.
struct alignas(64) BoxBlock {
  static constexpr std::uint32_t kSize = 8;

  double low[3][kSize];
  double high[3][kSize];

  void set(std::uint32_t lane, const Aabb& box) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis][lane] = box.low[axis];
      high[axis][lane] = box.high[axis];
    }
  }
};

}  // namespace collided::engine
