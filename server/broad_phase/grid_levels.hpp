#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "server/broad_phase/bsp_layout.hpp"
#include "server/geometry/aabb.hpp"

namespace collided::grid {

/// A box as eight doubles: low corner, negated high corner, number, 0. Two boxes overlap when the first six lanes
/// of one are at most the others' mirrored ones: one SIMD comparison.
struct alignas(64) Entry {
  double lane[8];

  double low(int axis) const { return lane[axis]; }
  double high(int axis) const { return -lane[3 + axis]; }
  std::uint32_t box() const { return static_cast<std::uint32_t>(lane[6]); }
};

using Cell = std::int64_t;
struct CellRange {
  Cell low[3];
  Cell high[3];
};

/// Runs of 64 cells along x share a row of the table, so that neighbours in x are neighbours in memory.
inline constexpr int kRowBits = 6;
inline constexpr Cell kRowMask = (Cell{1} << kRowBits) - 1;

/// Boxes of similar size, each held by the one cell of its low corner. The cell is larger than every box, so boxes
/// that overlap have cells at most one apart on each axis.
struct Level {
  double cell_m = 1;
  double inverse = 1;
  std::uint32_t first_bucket = 0;
  std::uint32_t row_mask = 0;  // rows start at bucket first_bucket + (hash & row_mask)
  std::uint32_t begin = 0;     // entries
  std::uint32_t end = 0;
  CellRange occupied;
  Aabb bounds;

  std::uint32_t count() const { return end - begin; }
  /// Within 2^41 of zero for the level's own boxes. Monotone, and its two roundings stay far below the 2^-9 by which
  /// the cell exceeds the boxes.
  Cell cell_of(double coordinate) const { return static_cast<Cell>(std::floor(coordinate * inverse)); }
  std::uint32_t row(Cell x, Cell y, Cell z) const {
    // Odd constants from the binary expansions of the golden ratio, e and pi; then the finaliser of SplitMix64.
    std::uint64_t hash = static_cast<std::uint64_t>(x >> kRowBits) * 0x9e3779b97f4a7c15u +
                         static_cast<std::uint64_t>(y) * 0xadf85458a2bb4a9bu +
                         static_cast<std::uint64_t>(z) * 0xc90fdaa22168c235u;
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9u;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebu;
    return first_bucket + (static_cast<std::uint32_t>(hash >> 32) & row_mask);
  }
  std::uint32_t bucket(Cell x, Cell y, Cell z) const {
    return row(x, y, z) + static_cast<std::uint32_t>(x & kRowMask);
  }
};

/// Sorted by bucket; bucket b holds entries [starts[b], starts[b + 1]). Boxes that no level suits (unbounded, or too
/// few of their size to be worth a table) are loose: every question asks each of them.
struct Levels {
  std::vector<Level> levels;  // small boxes first
  std::vector<std::uint32_t> starts;
  bsp::PlainArray<Entry> entries;
  std::uint32_t entry_count = 0;
  std::uint32_t loose_begin = 0;  // loose entries lie behind those of the levels

  // Scratch of rebuild, kept to save allocations.
  std::vector<std::uint32_t> bucket_of_box;
  std::vector<std::int16_t> exponent_of_box;

  void rebuild(std::span<const Aabb> boxes);
  std::size_t bytes() const;
};

}  // namespace collided::grid
