#include "tests/scenes/seed.hpp"

#include <cstdio>
#include <cstdlib>

namespace collided::scenes {

std::uint64_t seed() {
  const char* given = std::getenv("COLLIDED_SEED");
  const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 0) : 20240607;
  std::printf("COLLIDED_SEED=%llu\n", static_cast<unsigned long long>(seed));
  return seed;
}

}  // namespace collided::scenes
