#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/grid_pairs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "server/broad_phase/grid_walk.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::grid::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 8>;
constexpr Doubles kDoubles;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(kDoubles));

/// What an entry's lanes are compared with: the asked box mirrored, and infinity where anything passes.
struct alignas(64) Mirror {
  double lane[8];

  explicit Mirror(const Entry& entry) {
    for (int axis = 0; axis < 3; ++axis) {
      lane[axis] = entry.high(axis);
      lane[3 + axis] = -entry.low(axis);
    }
    lane[6] = lane[7] = std::numeric_limits<double>::infinity();
  }
};

HWY_INLINE bool overlaps(const Entry& entry, const Mirror& mirror) {
  auto all = hn::Le(hn::Load(kDoubles, entry.lane), hn::Load(kDoubles, mirror.lane));
  for (int first = kLanes; first < 8; first += kLanes) {
    all = hn::And(all, hn::Le(hn::Load(kDoubles, entry.lane + first), hn::Load(kDoubles, mirror.lane + first)));
  }
  return hn::AllTrue(kDoubles, all);
}

/// A place in a row that moves up with the sweep along x.
struct Cursor {
  std::uint32_t place;
  std::uint32_t end;
};

/// The search for all pairs: a sweep over the entries in memory order, with a cursor in each row beside.
struct Search {
  const Levels& levels;
  Grid::PairFound found;
  void* context;
  WalkCost& cost;

  HWY_INLINE void report(const Entry& a, const Entry& b) const {
    ++cost.candidates;
    found(context, std::min(a.box(), b.box()), std::max(a.box(), b.box()));
  }

  /// The row's entries with x in [low_x, high_x]; later calls have no lower low_x.
  HWY_INLINE void compare(const Entry& entry, const Mirror& mirror, Cursor& cursor, Cell low_x, Cell high_x) const {
    const Cell* x = levels.x_of_entry.data();
    while (cursor.place < cursor.end && x[cursor.place] < low_x) ++cursor.place;
    for (std::uint32_t i = cursor.place; i < cursor.end && x[i] <= high_x; ++i) {
      if (overlaps(levels.entries[i], mirror)) report(entry, levels.entries[i]);
    }
  }

  /// Every entry of a range, whatever its cell.
  HWY_INLINE void compare_all(const Entry& entry, std::uint32_t begin, std::uint32_t end) const {
    const Mirror mirror(entry);
    for (std::uint32_t i = begin; i < end; ++i) {
      if (overlaps(levels.entries[i], mirror)) report(entry, levels.entries[i]);
    }
  }

  HWY_INLINE void add_row(const Level& level, Cell y, Cell z, Cursor* cursors, int& count) const {
    ++cost.nodes;
    const std::uint32_t row = levels.find_row(level, y, z);
    if (row != kNoRow) cursors[count++] = {levels.rows[row].begin, levels.rows[row].end};
  }

  /// Within the row what follows, and half of the eight rows around: the other half finds this one.
  HWY_INLINE void own_level(const Level& level, const Row& row) const {
    const Cell* x = levels.x_of_entry.data();
    Cursor cursors[4];
    int count = 0;
    add_row(level, row.y + 1, row.z, cursors, count);
    for (Cell dy = -1; dy <= 1; ++dy) add_row(level, row.y + dy, row.z + 1, cursors, count);
    for (std::uint32_t i = row.begin; i < row.end; ++i) {
      const Entry& entry = levels.entries[i];
      const Mirror mirror(entry);
      for (std::uint32_t j = i + 1; j < row.end && x[j] <= x[i] + 1; ++j) {
        if (overlaps(levels.entries[j], mirror)) report(entry, levels.entries[j]);
      }
      for (int c = 0; c < count; ++c) compare(entry, mirror, cursors[c], x[i] - 1, x[i] + 1);
    }
  }

  /// A row of small boxes against a level of larger ones, at most three cells across.
  HWY_INLINE void larger_level(const Level& larger, const Row& row) const {
    CellRange rows{{0, 1, 1}, {0, 0, 0}};
    Cursor cursors[16];
    int count = 0;
    for (std::uint32_t i = row.begin; i < row.end; ++i) {
      const Entry& entry = levels.entries[i];
      const CellRange range = cells_reaching(larger, Vec3(entry.low(0), entry.low(1), entry.low(2)),
                                             Vec3(entry.high(0), entry.high(1), entry.high(2)));
      if (range.empty()) continue;
      bool same = true;
      for (int axis = 1; axis < 3; ++axis) {
        same = same && range.low[axis] == rows.low[axis] && range.high[axis] == rows.high[axis];
      }
      if (!same) {
        rows = range;
        count = 0;
        for (Cell z = range.low[2]; z <= range.high[2]; ++z) {
          for (Cell y = range.low[1]; y <= range.high[1]; ++y) add_row(larger, y, z, cursors, count);
        }
      }
      const Mirror mirror(entry);
      // Boxes of one cell differ in x by less than a cell, so the range's low end may step back by one.
      for (int c = 0; c < count; ++c) {
        Cursor from_start = cursors[c];
        compare(entry, mirror, from_start, range.low[0], range.high[0]);
        compare(entry, mirror, cursors[c], range.low[0] - 1, std::numeric_limits<Cell>::min());
      }
    }
  }
};

void FindPairs(const Levels& levels, Grid::PairFound found, void* context, WalkCost& cost) {
  const Search search{levels, found, context, cost};
  for (std::size_t l = 0; l < levels.levels.size(); ++l) {
    const Level& level = levels.levels[l];
    for (std::uint32_t row = level.row_begin; row < level.row_end; ++row) {
      search.own_level(level, levels.rows[row]);
      for (std::size_t larger = l + 1; larger < levels.levels.size(); ++larger) {
        search.larger_level(levels.levels[larger], levels.rows[row]);
      }
    }
  }
  for (std::uint32_t i = levels.loose_begin; i < levels.entry_count; ++i) {
    search.compare_all(levels.entries[i], 0, levels.loose_begin);
    search.compare_all(levels.entries[i], i + 1, levels.entry_count);
  }
}

}  // namespace collided::grid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::grid {

HWY_EXPORT(FindPairs);

void find_pairs(const Levels& levels, Grid::PairFound found, void* context, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(FindPairs)(levels, found, context, cost);
}

}  // namespace collided::grid
#endif
