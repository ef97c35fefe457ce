#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

/// The rays that both sides of the service benchmarks ask, without a type of either: seven numbers a ray (origin,
/// direction, length), of no common direction, through a terrain of 100 m.
inline std::vector<double> service_rays(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> along(-48, 48), height(2, 12), turn(-1, 1);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    numbers.insert(numbers.end(), {along(random), along(random), height(random), turn(random), turn(random),
                                   -0.2 - 0.2 * turn(random), 200});
  }
  return numbers;
}
