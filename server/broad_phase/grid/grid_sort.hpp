#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/broad_phase/grid/grid_key.hpp"

namespace collided::engine::grid {

/// A box and its key in one word, for keys of at most 32 bits.
struct Packed {
  std::uint64_t word;

  static Packed of(Key key, std::uint32_t box) { return {key << 32 | box}; }
  Key key() const { return word >> 32; }
  std::uint32_t box() const { return static_cast<std::uint32_t>(word); }
};
inline constexpr int kPackedKeyBits = 32;

/// A box and its key, for longer keys.
struct Keyed {
  std::uint64_t whole_key;
  std::uint32_t number;

  static Keyed of(Key key, std::uint32_t box) { return {key, box}; }
  Key key() const { return whole_key; }
  std::uint32_t box() const { return number; }
};

/// Sorts by the low `bits` of the keys; stable. One counting sort per digit; digits have equal width and are all
/// counted in one pass. `other` is scratch.
///
/// source  Knuth, "The Art of Computer Programming", 3, 5.2.5
template <class Element>
void radix_sort(std::vector<Element>& values, std::vector<Element>& other, int bits) {
  constexpr int kMostDigitBits = 11;
  if (bits <= 0) return;
  const int digits = (bits + kMostDigitBits - 1) / kMostDigitBits;
  const int digit_bits = (bits + digits - 1) / digits;
  const std::size_t values_a_digit = std::size_t{1} << digit_bits;
  const Key mask = values_a_digit - 1;
  std::vector<std::uint32_t> places(values_a_digit * static_cast<std::size_t>(digits));
  for (const Element& value : values) {
    Key rest = value.key();
    for (std::size_t first = 0; first < places.size(); first += values_a_digit, rest >>= digit_bits) {
      ++places[first + (rest & mask)];
    }
  }
  other.resize(values.size());
  for (int digit = 0; digit < digits; ++digit) {
    const std::span place(places.data() + static_cast<std::size_t>(digit) * values_a_digit, values_a_digit);
    std::uint32_t sum = 0;
    for (std::uint32_t& count : place) sum += std::exchange(count, sum);
    const int shift = digit * digit_bits;
    for (const Element& value : values) other[place[value.key() >> shift & mask]++] = value;
    values.swap(other);
  }
}

}  // namespace collided::engine::grid
