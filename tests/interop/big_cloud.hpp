#pragma once

#include <array>

namespace collided::interop {

/// Columns along x of the large cloud; a point of each column stands at the middle of a cell of 0.1 m of its own, at one of
/// 13 heights.
inline constexpr int kBigCloudColumns = 1'000;

inline std::array<float, 3> big_cloud_point(int number) {
  const auto middle = [](int cell) { return 0.1F * (static_cast<float>(cell) + 0.5F); };
  return {middle(number % kBigCloudColumns - kBigCloudColumns / 2), middle(number / kBigCloudColumns),
          middle(number * 7 % 13)};
}

}  // namespace collided::interop
