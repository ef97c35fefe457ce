#pragma once

#include <cstdint>

namespace collided::scenes {

/// The number in the environment variable COLLIDED_SEED, else a fixed one; printed, so that a failure can be repeated.
std::uint64_t seed();

}  // namespace collided::scenes
