#pragma once

#include <cstdint>
#include <vector>

namespace collided::engine::grid {

using Cell = std::int64_t;
/// A cell as one number: its numbers along z, y and x, from the high bits down.
using Key = std::uint64_t;

/// A key that no cell has: fills the places after a level's last box.
inline constexpr Key kNoKey = ~Key{0};
/// Keys of cells have at most this many bits, so that a step to a neighbouring cell never wraps.
inline constexpr int kMostKeyBits = 62;

/// A block of cells, both ends included.
struct CellRange {
  Cell low[3];
  Cell high[3];

  bool empty() const { return low[0] > high[0] || low[1] > high[1] || low[2] > high[2]; }
};

/// One axis of a level: numbers its cells with small numbers in the same order, such that cells at most one apart get
/// numbers at most one apart. One number on either side stays free, so that a neighbour's number never runs into the
/// next axis.
class Axis {
 public:
  /// Numbers the cells first .. last without gaps.
  void set(Cell first, Cell last);
  /// Numbers only these cells, given in any order and with repeats. For a world too wide to number all cells.
  void set(std::vector<Cell> cells);
  /// Halves the numbers of such a list this many times; neighbours may share a number after that.
  void coarsen(int times) { drop_ += times; }

  /// Bits that any number of the axis needs, its free neighbours included.
  int bits() const;
  std::uint64_t number(Cell cell) const {
    return distinct_.empty() ? static_cast<std::uint64_t>(cell - first_) + 1 : ranked_at_least(cell);
  }
  /// The number of the first occupied cell at or after this one, or a number after all.
  std::uint64_t at_least(Cell cell) const { return number(cell); }
  /// The number of the last occupied cell at or before this one, or a number before all.
  std::uint64_t at_most(Cell cell) const { return distinct_.empty() ? number(cell) : ranked_at_most(cell); }
  std::size_t bytes() const;

 private:
  std::uint64_t ranked_at_least(Cell cell) const;
  std::uint64_t ranked_at_most(Cell cell) const;

  Cell first_ = 0;
  Cell last_ = 0;
  int drop_ = 0;
  std::vector<Cell> distinct_;        // ascending; empty: all cells are numbered
  std::vector<std::uint64_t> ranks_;  // of distinct_: one apart where the cells are, else two
};

}  // namespace collided::engine::grid
