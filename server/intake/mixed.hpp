#pragma once

#include <cstdint>

namespace collided::engine {

/// A hash in which every bit of the result depends on every bit of the value. Pure; the same on every machine.
/// source    the finalizer of SplitMix64: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014
inline std::uint64_t mixed(std::uint64_t value) {
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
  return value ^ (value >> 31);
}

}  // namespace collided::engine
