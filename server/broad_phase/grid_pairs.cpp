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

/// One entry's search for partners.
struct Search {
  const Levels& levels;
  Grid::PairFound found;
  void* context;
  WalkCost& cost;

  HWY_INLINE void report(const Entry& a, const Entry& b) const {
    ++cost.candidates;
    found(context, std::min(a.box(), b.box()), std::max(a.box(), b.box()));
  }

  /// Entries [begin, end) whose cell is (x in [low_x, high_x], y, z); other cells may share the buckets.
  HWY_INLINE void compare(const Level& level, const Entry& entry, const Mirror& mirror, std::uint32_t begin,
                          std::uint32_t end, Cell low_x, Cell high_x, Cell y, Cell z) const {
    for (std::uint32_t i = begin; i < end; ++i) {
      const Entry& other = levels.entries[i];
      if (!overlaps(other, mirror)) continue;
      const Cell x = level.cell_of(other.low(0));
      if (x < low_x || x > high_x || level.cell_of(other.low(1)) != y || level.cell_of(other.low(2)) != z) continue;
      report(entry, other);
    }
  }

  HWY_INLINE void compare_row(const Level& level, const Entry& entry, const Mirror& mirror, Cell low_x, Cell high_x,
                              Cell y, Cell z) const {
    while (low_x <= high_x) {
      const Cell last = std::min(low_x | kRowMask, high_x);
      const std::uint32_t bucket = level.bucket(low_x, y, z);
      ++cost.nodes;
      compare(level, entry, mirror, levels.starts[bucket],
              levels.starts[bucket + static_cast<std::uint32_t>(last - low_x) + 1], low_x, last, y, z);
      low_x = last + 1;
    }
  }

  /// Every entry of a range, whatever its cell.
  HWY_INLINE void compare_all(const Entry& entry, std::uint32_t begin, std::uint32_t end) const {
    const Mirror mirror(entry);
    for (std::uint32_t i = begin; i < end; ++i) {
      if (overlaps(levels.entries[i], mirror)) report(entry, levels.entries[i]);
    }
  }

  /// Its own cell from itself on, and half of the 26 around: the other half finds this one.
  HWY_INLINE void own_level(const Level& level, std::uint32_t i) const {
    const Entry& entry = levels.entries[i];
    const Mirror mirror(entry);
    const Cell x = level.cell_of(entry.low(0));
    const Cell y = level.cell_of(entry.low(1));
    const Cell z = level.cell_of(entry.low(2));
    compare(level, entry, mirror, i + 1, levels.starts[level.bucket(x, y, z) + 1], x, x, y, z);
    compare_row(level, entry, mirror, x + 1, x + 1, y, z);
    compare_row(level, entry, mirror, x - 1, x + 1, y + 1, z);
    for (Cell dy = -1; dy <= 1; ++dy) compare_row(level, entry, mirror, x - 1, x + 1, y + dy, z + 1);
  }

  HWY_INLINE void larger_level(const Level& level, const Entry& entry) const {
    const CellRange range = cells_reaching(level, Vec3(entry.low(0), entry.low(1), entry.low(2)),
                                           Vec3(entry.high(0), entry.high(1), entry.high(2)));
    const Mirror mirror(entry);
    for (Cell z = range.low[2]; z <= range.high[2]; ++z) {
      for (Cell y = range.low[1]; y <= range.high[1]; ++y) {
        compare_row(level, entry, mirror, range.low[0], range.high[0], y, z);
      }
    }
  }
};

void FindPairs(const Levels& levels, Grid::PairFound found, void* context, WalkCost& cost) {
  const Search search{levels, found, context, cost};
  for (std::size_t l = 0; l < levels.levels.size(); ++l) {
    const Level& level = levels.levels[l];
    for (std::uint32_t i = level.begin; i < level.end; ++i) {
      search.own_level(level, i);
      for (std::size_t larger = l + 1; larger < levels.levels.size(); ++larger) {
        search.larger_level(levels.levels[larger], levels.entries[i]);
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
