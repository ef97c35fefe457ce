#pragma once

#include <cstdint>
#include <random>

namespace collided::engine::service {

/// An unguessable number that no other process draws, from the system's entropy.
inline std::uint64_t random_number() {
  std::random_device device;
  return (std::uint64_t{device()} << 32) | device();
}

}  // namespace collided::engine::service
