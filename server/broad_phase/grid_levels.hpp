#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/broad_phase/bsp_layout.hpp"
#include "server/geometry/aabb.hpp"

namespace collided::grid {

/// A box as eight doubles: low corner, negated high corner, number, 0. Two boxes overlap when the first six lanes
/// of one are at most the other's mirrored ones: one SIMD comparison.
struct alignas(64) Entry {
  double lane[8];

  double low(int axis) const { return lane[axis]; }
  double high(int axis) const { return -lane[3 + axis]; }
  std::uint32_t box() const { return static_cast<std::uint32_t>(lane[6]); }
};

using Cell = std::int64_t;

inline constexpr std::uint32_t kNoRow = 0xffffffffu;

/// The entries of one (y, z), in ascending x.
struct Row {
  Cell y;
  Cell z;
  std::uint32_t begin;
  std::uint32_t end;
};

struct CellRange {
  Cell low[3];
  Cell high[3];

  bool empty() const { return low[0] > high[0] || low[1] > high[1] || low[2] > high[2]; }
  /// How many (y, z) it has; a double, since it may exceed any integer.
  double row_count() const {
    return (static_cast<double>(high[1] - low[1]) + 1) * (static_cast<double>(high[2] - low[2]) + 1);
  }
};

/// Boxes of similar size, each held by the one cell of its low corner. The cell is larger than every box, so boxes
/// that overlap have cells at most one apart on each axis.
struct Level {
  double cell_m = 1;
  double inverse = 1;
  std::uint32_t begin = 0;  // entries
  std::uint32_t end = 0;
  std::uint32_t row_begin = 0;
  std::uint32_t row_end = 0;
  std::uint32_t first_slot = 0;  // of its part of the hash table
  std::uint32_t slot_mask = 0;
  CellRange occupied;
  Aabb bounds;

  std::uint32_t count() const { return end - begin; }
  /// Within 2^41 of zero for the level's own boxes. Monotone, and its two roundings stay far below the 2^-9 by which
  /// the cell exceeds the boxes.
  Cell cell_of(double coordinate) const {
    const double place = coordinate * inverse;
    const auto toward_zero = static_cast<Cell>(place);
    return toward_zero - (place < static_cast<double>(toward_zero) ? 1 : 0);
  }
  std::uint32_t slot_of(Cell y, Cell z) const {
    // Odd constants from the binary expansions of e and pi; then the finaliser of SplitMix64.
    std::uint64_t hash = static_cast<std::uint64_t>(y) * 0xadf85458a2bb4a9bu +
                         static_cast<std::uint64_t>(z) * 0xc90fdaa22168c235u;
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9u;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebu;
    return static_cast<std::uint32_t>(hash >> 32) & slot_mask;
  }
};

/// Entries sorted by level, z, y, x of their cells, so that a sweep in memory order meets its neighbours in a few
/// parallel streams. Boxes that no level suits (unbounded, or too few of their size to be worth one) are loose: every
/// question asks each of them.
struct Levels {
  std::vector<Level> levels;  // small boxes first
  bsp::PlainArray<Entry> entries;
  std::vector<Cell> x_of_entry;
  std::vector<Row> rows;
  std::vector<std::uint32_t> slots;  // row numbers by hash, open addressing
  std::uint32_t entry_count = 0;
  std::uint32_t loose_begin = 0;  // loose entries lie behind those of the levels

  /// Row number, or kNoRow.
  std::uint32_t find_row(const Level& level, Cell y, Cell z) const {
    for (std::uint32_t slot = level.slot_of(y, z);; slot = (slot + 1) & level.slot_mask) {
      const std::uint32_t row = slots[level.first_slot + slot];
      if (row == kNoRow || (rows[row].y == y && rows[row].z == z)) return row;
    }
  }

  void rebuild(std::span<const Aabb> boxes);
  std::size_t bytes() const;

 private:
  void choose_levels(std::span<const Aabb> boxes);
  void fill_level(std::span<const Aabb> boxes, std::span<const std::uint32_t> members, Level& level);
  void index_rows(Level& level);

  // Scratch of rebuild, kept to save allocations.
  std::vector<std::int16_t> exponent_of_box_;
  std::vector<std::int16_t> level_of_exponent_;
  std::vector<std::uint32_t> members_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint64_t> other_keys_;
};

}  // namespace collided::grid
