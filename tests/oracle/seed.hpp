#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace collided::oracle {

/// The seed of a random test: COLLIDED_SEED if it is set, else the given one; printed, so that a failure can be run
/// again.
inline std::mt19937_64 seeded(std::uint64_t fallback) {
  const char* asked = std::getenv("COLLIDED_SEED");
  const std::uint64_t seed = asked != nullptr ? std::strtoull(asked, nullptr, 10) : fallback;
  std::printf("COLLIDED_SEED=%llu\n", static_cast<unsigned long long>(seed));
  return std::mt19937_64(seed);
}

/// The number of cases that this environment variable asks for, for a test's long form; else the given number.
inline int asked(const char* variable, int fallback) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::atoi(text) : fallback;
}

}  // namespace collided::oracle
