#pragma once

#include <cstdint>
#include <random>

#include "server/geometry/vector.hpp"

namespace collided::simulation {

/// What a run draws from its seed.
class SeededChoices {
 protected:
  explicit SeededChoices(std::uint64_t seed) : random_(seed) {}

  bool chance(double probability) { return std::uniform_real_distribution<double>()(random_) < probability; }
  std::int64_t up_to(std::int64_t most_ns) {
    return static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(most_ns + 1));
  }
  engine::Vec3 any_place() {
    std::uniform_real_distribution<double> coordinate(-1.2, 1.2);
    const double x = coordinate(random_);
    const double y = coordinate(random_);
    return {x, y, coordinate(random_)};
  }

  std::mt19937_64 random_;
};

}  // namespace collided::simulation
