#pragma once

#include <cstdint>
#include <vector>

namespace collided::engine::grid {

using Cell = std::int64_t;
/// A cell as one number: z, y, x of its column from the high bits down.
using Key = std::uint64_t;

/// No cell's key: what lies behind a level's last box.
inline constexpr Key kNoKey = ~Key{0};
/// Keys of cells stay below, so that a step to a neighbouring cell never wraps.
inline constexpr int kMostKeyBits = 62;

struct CellRange {
  Cell low[3];
  Cell high[3];

  bool empty() const { return low[0] > high[0] || low[1] > high[1] || low[2] > high[2]; }
};

/// One axis of a level: its cells as small numbers in the same order, where cells at most one apart get numbers at most
/// one apart. A free number remains on either side, so that a neighbour's number never runs into the next axis.
class Axis {
 public:
  /// Cells first .. last, numbered straight.
  void set(Cell first, Cell last);
  /// Only these cells, in any order and repeated at will: what lies between is left out. For a world too wide to be
  /// numbered straight.
  void set(std::vector<Cell> cells);
  /// Halves the numbers of such a list so often; neighbours may share one from then on.
  void coarsen(int times) { drop_ += times; }

  int bits() const;
  std::uint64_t number(Cell cell) const {
    return distinct_.empty() ? static_cast<std::uint64_t>(cell - first_) + 1 : ranked_at_least(cell);
  }
  /// The number of the first cell that is occupied from here on, or a later number than any.
  std::uint64_t at_least(Cell cell) const { return number(cell); }
  /// The number of the last cell that is occupied up to here, or an earlier number than any.
  std::uint64_t at_most(Cell cell) const { return distinct_.empty() ? number(cell) : ranked_at_most(cell); }
  std::size_t bytes() const;

 private:
  std::uint64_t ranked_at_least(Cell cell) const;
  std::uint64_t ranked_at_most(Cell cell) const;

  Cell first_ = 0;
  Cell last_ = 0;
  int drop_ = 0;
  std::vector<Cell> distinct_;        // ascending
  std::vector<std::uint64_t> ranks_;  // of distinct_; one apart where the cells are, else two
};

}  // namespace collided::engine::grid
