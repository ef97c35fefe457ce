#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Merges the occupied cells of a grid (table Voxels of scene.fbs) into few blocks. Server and client get the same
/// blocks.
namespace collided::wire_contract {

/// A block of cells: its lowest cell, and its number of cells along each axis.
struct CellBlock {
  std::array<std::uint32_t, 3> low;
  std::array<std::uint32_t, 3> size;
};

/// Grows disjoint blocks of cells: along x, then y, then z.
class BlockGrowth {
 public:
  /// size      cells along each axis
  /// occupied  bit i + size[0] * (j + size[1] * k), low bits of a byte first; the minimum number of bytes, with zeros
  ///           after the last bit
  BlockGrowth(const std::array<std::uint32_t, 3>& size, std::span<const std::uint8_t> occupied)
      : size_(size), left_(occupied.begin(), occupied.end()) {}

  /// Calls take(block) for each block. Call it once.
  template <class Take>
  void run(Take&& take) {
    // A block that begins at a cell contains only later cells.
    for (std::size_t byte = 0; byte < left_.size(); ++byte) {
      while (left_[byte] != 0) {
        const auto at = static_cast<std::uint32_t>(8 * byte + static_cast<std::size_t>(std::countr_zero(left_[byte])));
        take(grown_from({at % size_[0], at / size_[0] % size_[1], at / size_[0] / size_[1]}));
      }
    }
  }

 private:
  std::size_t bit(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return x + std::size_t{size_[0]} * (y + std::size_t{size_[1]} * z);
  }
  bool is_left(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    const std::size_t at = bit(x, y, z);
    return (left_[at / 8] >> (at % 8) & 1) != 0;
  }
  template <class Visit>
  static bool all_of(const CellBlock& block, Visit&& visit) {
    for (std::uint32_t z = 0; z < block.size[2]; ++z) {
      for (std::uint32_t y = 0; y < block.size[1]; ++y) {
        for (std::uint32_t x = 0; x < block.size[0]; ++x) {
          if (!visit(block.low[0] + x, block.low[1] + y, block.low[2] + z)) return false;
        }
      }
    }
    return true;
  }
  CellBlock grown_from(const std::array<std::uint32_t, 3>& low) {
    CellBlock block{low, {1, 1, 1}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      while (low[axis] + block.size[axis] < size_[axis]) {
        CellBlock next = block;
        next.low[axis] += block.size[axis];
        next.size[axis] = 1;
        if (!all_of(next, [&](auto x, auto y, auto z) { return is_left(x, y, z); })) break;
        ++block.size[axis];
      }
    }
    all_of(block, [&](auto x, auto y, auto z) {
      const std::size_t at = bit(x, y, z);
      left_[at / 8] = static_cast<std::uint8_t>(left_[at / 8] & ~(1U << (at % 8)));
      return true;
    });
    return block;
  }

  std::array<std::uint32_t, 3> size_;
  std::vector<std::uint8_t> left_;
};

}  // namespace collided::wire_contract
