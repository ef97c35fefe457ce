#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace collided::engine {

/// The number stored at `bytes` in the given byte order, at any alignment.
template <class Number>
Number number_at(const char* bytes, std::endian order) {
  std::array<char, sizeof(Number)> copy;
  std::memcpy(copy.data(), bytes, sizeof(Number));
  if (order != std::endian::native) { std::reverse(copy.begin(), copy.end()); }
  return std::bit_cast<Number>(copy);
}

}  // namespace collided::engine
