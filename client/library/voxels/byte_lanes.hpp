#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

/// Operations on a word's bits and 64 corresponding bytes, eight at a time in the lanes of a 64-bit number.
namespace collided::client {

inline constexpr std::uint64_t kEachLane = 0x0101'0101'0101'0101;
inline constexpr std::uint64_t kTopBits = 0x8080'8080'8080'8080;

inline std::uint64_t load_lanes(const std::uint8_t* bytes) {
  std::uint64_t lanes = 0;
  std::memcpy(&lanes, bytes, sizeof lanes);
  return lanes;
}

/// Sets the bytes whose bits are 1.
inline void set_lanes(std::uint8_t* bytes, std::uint64_t bits, std::uint8_t value) {
  static_assert(std::endian::native == std::endian::little, "lane i is byte i");
  for (std::size_t group = 0; group < 8; ++group, bytes += 8, bits >>= 8) {
    // Each lane keeps one bit, which then fills the lane.
    const std::uint64_t own = (bits & 0xff) * kEachLane & 0x8040'2010'0804'0201;
    const std::uint64_t mask = ((own + 0x7f7f'7f7f'7f7f'7f7f) & kTopBits) / 0x80 * 0xff;
    const std::uint64_t lanes = (load_lanes(bytes) & ~mask) | (kEachLane * value & mask);
    std::memcpy(bytes, &lanes, sizeof lanes);
  }
}

/// The bits of the bytes that are more than `most` behind `now`, modulo 256.
///
/// most  below 128
inline std::uint64_t lanes_older(const std::uint8_t* bytes, std::uint8_t now, std::uint8_t most) {
  const std::uint64_t now_lanes = kEachLane * now;
  const std::uint64_t carry = kEachLane * (0x7fU - most);
  std::uint64_t bits = 0;
  for (std::size_t group = 0; group < 8; ++group) {
    const std::uint64_t lanes = load_lanes(bytes + 8 * group);
    // No lane borrows from the next one.
    const std::uint64_t age = ((now_lanes | kTopBits) - (lanes & ~kTopBits)) ^ ((now_lanes ^ ~lanes) & kTopBits);
    const std::uint64_t is_older = (((age & ~kTopBits) + carry) | age) & kTopBits;
    bits |= ((is_older >> 7) * 0x0102'0408'1020'4080 >> 56) << (8 * group);
  }
  return bits;
}

}  // namespace collided::client
