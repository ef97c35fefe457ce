#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/grid/grid_pairs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "server/broad_phase/box_block-inl.hpp"
#include "server/broad_phase/grid/grid_walk.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::grid::HWY_NAMESPACE {
using Asked = engine::HWY_NAMESPACE::AskedBox;
constexpr unsigned kAllLanes = (1u << kBlock) - 1;

constexpr int kWindows = 5;

/// Overlaps of a box in one block of each of its windows, eight bits per window.
struct Met {
  std::uint64_t lanes;
  std::uint32_t place;
  std::uint32_t block[kWindows];
};

/// Collects hits until there are several: reporting each at once would be a branch on its comparisons, rarely
/// predicted, that waits for all of them.
struct Meetings {
  static constexpr std::uint32_t kSize = 64;
  Met met[kSize + 1];
  std::uint32_t count = 0;

  HWY_INLINE void add(const Met& one) {
    met[count] = one;
    count += one.lanes != 0 ? 1 : 0;
  }
};

/// The search for all pairs. Each search returns false once the walk is over.
struct PairSearch {
  const Levels& levels;
  Grid::PairFound found;
  WalkCost& cost;

  Key last_key(std::uint32_t block) const { return levels.keys[block * kBlock + kBlock - 1]; }

  bool report(std::uint32_t number, std::uint32_t place) const {
    ++cost.candidates;
    const std::uint32_t other = levels.numbers[place];
    return found(std::min(number, other), std::max(number, other));
  }

  /// Keys of a neighbouring row differ by the same amount all over the level: window w holds the keys in [key +
  /// to_row[w], key + to_row[w] + span(w)]. Searches the box's own row from the box on, and half of the eight rows
  /// around it: from the other half, this box itself is found.
  struct Rows {
    Key to_row[kWindows];

    explicit Rows(const GridLevel& level) {
      const Key y_step = Key{1} << level.y_shift;
      const Key z_step = Key{1} << level.z_shift;
      const Key all[kWindows] = {0, y_step - 1, z_step - y_step - 1, z_step - 1, z_step + y_step - 1};
      std::copy(all, all + kWindows, to_row);
    }
    static constexpr Key span(int window) { return window == 0 ? 1 : 2; }
  };

  /// Reports the collected hits. Lanes of other rows in the same block belong to those rows' windows.
  HWY_NOINLINE bool tell(const Rows& rows, Meetings& meetings) const {
    for (std::uint32_t i = 0; i < meetings.count; ++i) {
      const Met& met = meetings.met[i];
      const Key key = levels.keys[met.place];
      for (std::uint64_t lanes = met.lanes; lanes != 0; lanes &= lanes - 1) {
        const auto bit = static_cast<std::uint32_t>(__builtin_ctzll(lanes));
        const std::uint32_t place = met.block[bit / kBlock] * kBlock + bit % kBlock;
        const bool of_row =
            levels.keys[place] - key - rows.to_row[bit / kBlock] <= Rows::span(static_cast<int>(bit / kBlock));
        if (of_row && !report(levels.numbers[met.place], place)) return false;
      }
    }
    meetings.count = 0;
    return true;
  }

  /// Continues the windows that reach beyond their first block; one bit of `more` per window.
  HWY_NOINLINE bool go_on(const Asked& asked, const Rows& rows, Met met, unsigned more, Meetings& meetings) const {
    const Key key = levels.keys[met.place];
    for (; more != 0; more &= more - 1) {
      const int w = __builtin_ctz(more);
      const Key last = key + rows.to_row[w] + Rows::span(w);
      while (last_key(met.block[w]) <= last) {
        ++met.block[w];
        met.lanes = static_cast<std::uint64_t>(asked.overlapping(levels.blocks[met.block[w]]))
                    << (w * static_cast<int>(kBlock));
        meetings.add(met);
        if (meetings.count == Meetings::kSize && !tell(rows, meetings)) return false;
      }
    }
    return true;
  }

  /// All pairs within a level: a sweep in which every window moves along.
  HWY_INLINE bool own_level(const GridLevel& level) const {
    const Key* last = levels.keys.data() + kBlock - 1;
    const Rows rows(level);
    Meetings meetings;
    Met met{0, 0, {}};
    for (std::uint32_t& block : met.block) block = level.begin / kBlock;
    for (std::uint32_t place = level.begin; place < level.end; ++place) {
      const Key key = levels.keys[place];
      const BoxBlock& own = levels.blocks[place / kBlock];
      const Asked asked(own, place % kBlock);
      met.place = place;
      met.block[0] = place / kBlock;
      met.lanes = asked.overlapping(own) & (kAllLanes << 1 << place % kBlock) & kAllLanes;
      unsigned more = last[met.block[0] * kBlock] <= key + 1 ? 1 : 0;
      for (int w = 1; w < kWindows; ++w) {
        const Key first = key + rows.to_row[w];
        std::uint32_t block = met.block[w];
        while (last[block * kBlock] < first) ++block;
        met.block[w] = block;
        met.lanes |= static_cast<std::uint64_t>(asked.overlapping(levels.blocks[block]))
                     << (w * static_cast<int>(kBlock));
        more |= (last[block * kBlock] <= first + 2 ? 1u : 0u) << w;
      }
      meetings.add(met);
      if (HWY_UNLIKELY(meetings.count == Meetings::kSize) && !tell(rows, meetings)) return false;
      if (HWY_UNLIKELY(more != 0) && !go_on(asked, rows, met, more, meetings)) return false;
    }
    return tell(rows, meetings);
  }

  /// Compares a box with all boxes of a range of places, whatever their cells.
  HWY_INLINE bool compare_all(std::uint32_t place, std::uint32_t from_place, std::uint32_t end_place) const {
    const Asked asked(levels.blocks[place / kBlock], place % kBlock);
    const std::uint32_t number = levels.numbers[place];
    for (std::uint32_t block = from_place / kBlock; block * kBlock < end_place; ++block) {
      unsigned met = asked.overlapping(levels.blocks[block]);
      if (block * kBlock < from_place) met &= kAllLanes << (from_place % kBlock);
      for (; met != 0; met &= met - 1) {
        if (!report(number, block * kBlock + static_cast<std::uint32_t>(__builtin_ctz(met)))) return false;
      }
    }
    return true;
  }

  /// All pairs of a level of small boxes and one of larger boxes.
  HWY_INLINE bool larger_level(const GridLevel& level, const GridLevel& larger) const {
    for (std::uint32_t place = level.begin; place < level.end; ++place) {
      const Entry entry = levels.entry(place);
      const CellRange cells = cells_reaching(larger, Vec3(entry.low(0), entry.low(1), entry.low(2)),
                                             Vec3(entry.high(0), entry.high(1), entry.high(2)));
      if (cells.empty()) continue;
      const NumberRange range(larger, cells);
      if (range.empty()) continue;
      const Asked asked(*entry.block, entry.lane);
      const auto compare_row = [&](Key first, Key last) {
        const std::uint32_t from = levels.first_place(larger, first);
        if (levels.keys[from] > last) return true;
        for (std::uint32_t block = from / kBlock;; ++block) {
          for (unsigned lanes = asked.overlapping(levels.blocks[block]); lanes != 0; lanes &= lanes - 1) {
            const std::uint32_t other = block * kBlock + static_cast<std::uint32_t>(__builtin_ctz(lanes));
            if (levels.keys[other] - first <= last - first && !report(entry.number, other)) return false;
          }
          if (last_key(block) > last) return true;
        }
      };
      if (!for_each_row_in(larger, range, cost, compare_row)) return false;
    }
    return true;
  }
};

void FindPairs(const Levels& levels, Grid::PairFound found, WalkCost& cost) {
  const PairSearch search{levels, found, cost};
  for (std::size_t l = 0; l < levels.levels.size(); ++l) {
    if (!search.own_level(levels.levels[l])) return;
    for (std::size_t larger = l + 1; larger < levels.levels.size(); ++larger) {
      if (!search.larger_level(levels.levels[l], levels.levels[larger])) return;
    }
  }
  for (std::uint32_t i = levels.loose_begin; i < levels.loose_end; ++i) {
    if (!search.compare_all(i, 0, levels.loose_begin)) return;
    if (!search.compare_all(i, i + 1, levels.loose_end)) return;
  }
}

}  // namespace collided::engine::grid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::grid {

HWY_EXPORT(FindPairs);

namespace {

void find_few_pairs(const Levels& levels, Grid::PairFound found, WalkCost& cost) {
  const auto named = [&](std::uint32_t first, std::uint32_t second) {
    return found(levels.few_numbers[first], levels.few_numbers[second]);
  };
  levels.few.pairs(named, cost);
}

}  // namespace

void find_pairs(const Levels& levels, Grid::PairFound found, WalkCost& cost) {
  if (levels.few.size() > 0) return find_few_pairs(levels, found, cost);
  HWY_DYNAMIC_DISPATCH(FindPairs)(levels, found, cost);
}

}  // namespace collided::engine::grid
#endif
