#pragma once

#include <array>
#include <cstdint>

#include "collided/voxels.hpp"

namespace collided::client {

inline constexpr int kTileBits = 4;
inline constexpr std::int32_t kTileSide = 1 << kTileBits;
inline constexpr std::size_t kTileCells = std::size_t{1} << (3 * kTileBits);
inline constexpr int kBrickBits = 2;
inline constexpr std::size_t kTileWords = kTileCells / 64;

/// One bit per cell. A word is a brick of 4 x 4 x 4 cells, with bit x + 4 * (y + 4 * z); the bricks of a tile are
/// ordered in the same way.
using TileBits = std::array<std::uint64_t, kTileWords>;
inline constexpr std::uint64_t kAllBits = ~std::uint64_t{0};

/// A block of 16 x 16 x 16 cells. If free cells are not kept, a free cell equals one that was never met. Invariant:
/// occupied and fresh are subsets of known.
struct VoxelTile {
  VoxelNumber place{};  // in tiles
  TileBits known{};     // met by a scan and not decayed since
  TileBits occupied{};
  TileBits fresh{};                             // met by a scan in fresh_tick
  std::array<std::int8_t, kTileCells> odds{};   // log odds of being occupied, in steps of 0.05, of occupied cells
  std::array<std::uint8_t, kTileCells> seen{};  // tick of the last scan that met the cell, modulo 256
  std::int64_t fresh_tick = 0;
  bool is_changed = false;  // since the owner last took the changes

  // State of the current scan.
  bool is_met = false;
  TileBits hit{};             // cells with points
  TileBits open{};            // cells that a ray would change, before the rays
  TileBits crossed{};         // by rays; cells that are not open may be missing
  std::uint64_t settled = 0;  // bricks that rays no longer change

  // The state that the owner has published: occupied and unknown cells, and the time.
  TileBits told_occupied{};
  TileBits told_unknown{};
  std::int64_t told_ns = 0;
  bool is_told = false;

  bool is_empty() const { return known == TileBits{}; }
};

/// The index of a cell's bit in a tile: the brick's number times 64, plus the cell's number in the brick.
inline std::size_t cell_in_tile(const VoxelNumber& cell) {
  constexpr std::int32_t kBrickMask = (1 << kBrickBits) - 1;
  std::size_t at = 0;
  for (std::size_t axis = 3; axis-- > 0;)
    at = at << kBrickBits | static_cast<std::size_t>(cell[axis] >> kBrickBits & kBrickMask);
  for (std::size_t axis = 3; axis-- > 0;) at = at << kBrickBits | static_cast<std::size_t>(cell[axis] & kBrickMask);
  return at;
}
inline std::size_t brick_in_tile(const VoxelNumber& brick) {
  constexpr std::int32_t kMask = (1 << (kTileBits - kBrickBits)) - 1;
  return static_cast<std::size_t>((brick[0] & kMask) | (brick[1] & kMask) << 2 | (brick[2] & kMask) << 4);
}
inline VoxelNumber tile_of(const VoxelNumber& cell) {
  return {cell[0] >> kTileBits, cell[1] >> kTileBits, cell[2] >> kTileBits};
}
/// The cell with this index in the tile at that place.
inline VoxelNumber cell_of(const VoxelNumber& place, std::size_t cell_in_tile) {
  constexpr std::size_t kBrickMask = (1 << kBrickBits) - 1;
  VoxelNumber cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t brick = cell_in_tile >> (3 + axis) * kBrickBits & kBrickMask;
    const std::size_t within = cell_in_tile >> axis * kBrickBits & kBrickMask;
    cell[axis] = place[axis] * kTileSide + static_cast<std::int32_t>(brick << kBrickBits | within);
  }
  return cell;
}
/// The 16 cells along x of row y + 16 * z.
inline std::uint32_t row_of(const TileBits& bits, std::size_t row) {
  const std::size_t first_brick = (row >> 2 & 3) << 2 | row >> 6 << 4;
  const std::size_t shift = (row & 3) << 2 | (row >> 4 & 3) << 4;
  std::uint32_t cells = 0;
  for (std::size_t brick = 0; brick < 4; ++brick)
    cells |= static_cast<std::uint32_t>(bits[first_brick + brick] >> shift & 0xf) << 4 * brick;
  return cells;
}
inline bool has_bit(const TileBits& bits, std::size_t cell) { return (bits[cell / 64] >> (cell % 64) & 1) != 0; }
inline void set_bit(TileBits& bits, std::size_t cell) { bits[cell / 64] |= std::uint64_t{1} << (cell % 64); }

}  // namespace collided::client
