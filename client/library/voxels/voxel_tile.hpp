#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "collided/voxels.hpp"

namespace collided::client {

inline constexpr int kTileBits = 4;
inline constexpr std::int32_t kTileSide = 1 << kTileBits;
inline constexpr std::size_t kTileCells = std::size_t{1} << (3 * kTileBits);
inline constexpr std::size_t kTileWords = kTileCells / 64;

/// One bit a cell: bit x + 16 * (y + 16 * z).
using TileBits = std::array<std::uint64_t, kTileWords>;

/// A block of 16 x 16 x 16 cells.
/// Always: occupied is within known.
struct VoxelTile {
  VoxelNumber place{};  // in tiles
  TileBits known{};     // met by a scan and not decayed since
  TileBits occupied{};
  TileBits hit{};                               // of the scan at work: cells with points ...
  TileBits crossed{};                           // ... and cells that rays cross
  std::array<std::int8_t, kTileCells> odds{};   // log odds of being occupied, in steps of 0.05, of known cells
  std::array<std::uint8_t, kTileCells> seen{};  // tick of the last scan that met the cell, modulo 256
  bool is_met = false;                          // by the scan at work
  bool is_changed = false;                      // since its owner last took the changes

  bool has_occupied = false;
  bool is_all_known = false;
  std::int64_t applied_tick = -1;  // of the last scan that met it
  // What its owner has told of it: that cells are occupied, or unknown, and when.
  TileBits told_occupied{};
  TileBits told_unknown{};
  std::int64_t told_ns = 0;
  bool is_told = false;

  void note_bits() {
    has_occupied = occupied != TileBits{};
    is_all_known =
        std::all_of(known.begin(), known.end(), [](std::uint64_t word) { return word == ~std::uint64_t{0}; });
  }
  bool is_empty() const { return known == TileBits{}; }
};

inline std::size_t cell_in_tile(const VoxelNumber& cell) {
  constexpr std::int32_t kMask = kTileSide - 1;
  return static_cast<std::size_t>((cell[0] & kMask) | (cell[1] & kMask) << kTileBits |
                                  (cell[2] & kMask) << (2 * kTileBits));
}
inline VoxelNumber tile_of(const VoxelNumber& cell) {
  return {cell[0] >> kTileBits, cell[1] >> kTileBits, cell[2] >> kTileBits};
}
inline bool has_bit(const TileBits& bits, std::size_t cell) { return (bits[cell / 64] >> (cell % 64) & 1) != 0; }
inline void set_bit(TileBits& bits, std::size_t cell) { bits[cell / 64] |= std::uint64_t{1} << (cell % 64); }

}  // namespace collided::client
