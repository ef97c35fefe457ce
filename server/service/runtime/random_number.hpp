#pragma once

#include <cstdint>
#include <random>

namespace collided::engine::service {

/// That nobody can guess and no other process draws.
inline std::uint64_t random_number() {
  std::random_device device;
  return (std::uint64_t{device()} << 32) | device();
}

}  // namespace collided::engine::service
