#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "server/broad_phase/box_block.hpp"
#include "server/broad_phase/grid/grid_key.hpp"
#include "server/broad_phase/grid/grid_sort.hpp"
#include "server/broad_phase/hierarchy/box_tree.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/broad_phase/sweep_and_prune/sweep_and_prune.hpp"
#include "server/geometry/aabb.hpp"

namespace collided::engine::grid {

inline constexpr std::uint32_t kBlock = BoxBlock::kSize;

/// Up to this many boxes are swept along an axis instead: a frame of 64 then costs 2 to 3 us, not 10 (grid_bench), and
/// a query that tests every one costs no more than one that searches.
inline constexpr std::size_t kSweptBoxes = 64;

/// One stored box.
struct Entry {
  const BoxBlock* block;
  std::uint32_t lane;
  std::uint32_t number;

  double low(int axis) const { return block->low[axis][lane]; }
  double high(int axis) const { return block->high[axis][lane]; }
  std::uint32_t box() const { return number; }
};

/// Boxes of similar size, each stored in the cell of its low corner. Cells are larger than every box on each axis, so
/// overlapping boxes have cells at most one apart; for parallel needles the cells are equally narrow.
struct GridLevel {
  Vec3 cell_m = Vec3::Ones();
  Vec3 inverse = Vec3::Ones();
  std::uint32_t begin = 0;  // first and last place of its boxes; begin is the first of a block
  std::uint32_t end = 0;
  std::uint32_t first_bucket = 0;  // start of its part of the directory
  int bucket_shift = 0;
  // Shifts of a key to its bucket, and of the y and z numbers within a key.
  Key last_key = 0;
  int y_shift = 0;
  int z_shift = 0;
  Axis axes[3];
  CellRange occupied;
  Aabb bounds;

  std::uint32_t count() const { return end - begin; }
  /// The cell of a coordinate; within 2^41 of zero for the level's own boxes. Monotone, and its two roundings stay far
  /// below the 2^-9 by which a cell exceeds the boxes.
  Cell cell_of(int axis, double coordinate) const {
    const double place = coordinate * inverse[axis];
    const auto toward_zero = static_cast<Cell>(place);
    return toward_zero - (place < static_cast<double>(toward_zero) ? 1 : 0);
  }
  Key key(std::uint64_t x, std::uint64_t y, std::uint64_t z) const { return z << z_shift | y << y_shift | x; }
  Key key(const Vec3& corner) const {
    return key(axes[0].number(cell_of(0, corner[0])), axes[1].number(cell_of(1, corner[1])),
               axes[2].number(cell_of(2, corner[2])));
  }
};

/// The bounds of some boxes, and how far their low corners reach.
struct Extent {
  Aabb bounds;
  Vec3 highest_low = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void extend(const Aabb& box) {
    bounds.extend(box);
    highest_low = highest_low.cwiseMax(box.low);
  }
};

/// Memory used only during a rebuild, kept to save allocations; grids rebuilt in turn share it.
struct RebuildScratch {
  std::vector<Aabb> few_boxes;
  std::vector<std::int16_t> level_of_exponent;
  std::vector<std::uint32_t> members;
  std::vector<Packed> packed;
  std::vector<Packed> other_packed;
  std::vector<Keyed> keyed;
  std::vector<Keyed> other_keyed;

  std::size_t bytes() const;
};

/// Boxes sorted by level and key, so that a sweep in memory order meets its neighbours in a few parallel streams. After
/// a level's last box there is at least one place with kNoKey. Boxes that fit no level (unbounded, or too few of their
/// size for one) are loose: every query tests each of them. If there are few boxes all are loose.
struct Levels {
  std::vector<GridLevel> levels;  // small boxes first
  bvh::PlainArray<BoxBlock> blocks;
  bvh::PlainArray<Key> keys;               // by place
  bvh::PlainArray<std::uint32_t> numbers;  // by place
  std::vector<std::uint32_t> directory;    // by bucket of keys: first place of the bucket
  std::uint32_t entry_count = 0;
  std::uint32_t loose_begin = 0;  // places after the levels; the first of a block
  std::uint32_t loose_end = 0;
  SweepAndPrune few;                       // if there are at most kSweptBoxes, all of them; else empty
  std::vector<std::uint32_t> few_numbers;  // numbers of its boxes, ascending
  std::optional<BoxTree> tree;  // over all boxes, for rays and distances; none for so few that each is tested

  Entry entry(std::uint32_t place) const { return {&blocks[place / kBlock], place % kBlock, numbers[place]}; }
  /// The level's first place with at least this key; its end if there is none.
  std::uint32_t first_place(const GridLevel& level, Key key) const {
    if (key > level.last_key) return level.end;
    const std::uint32_t* bucket = directory.data() + level.first_bucket + (key >> level.bucket_shift);
    std::uint32_t low = bucket[0];
    std::uint32_t high = bucket[1];
    while (low < high) {
      const std::uint32_t middle = low + (high - low) / 2;
      if (keys[middle] < key) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }

  /// for_rays: with a tree.
  void rebuild(std::span<const Aabb> boxes, bool for_rays, RebuildScratch& scratch);
  /// True if the last rebuild had a non-empty box of this number.
  bool holds(std::uint32_t number) const;
  std::size_t bytes() const;

 private:
  bool are_few(std::span<const Aabb> boxes);
  void rebuild_few(std::span<const Aabb> boxes, RebuildScratch& scratch);
  void rebuild_many(std::span<const Aabb> boxes, RebuildScratch& scratch);
  void choose_levels(std::span<const Aabb> boxes, RebuildScratch& scratch);
  std::uint32_t lay_out();
  void share_out(std::span<const Aabb> boxes, RebuildScratch& scratch);
  void set_axes(std::span<const Aabb> boxes, GridLevel& level, std::span<const std::uint32_t> members);
  template <class Element>
  void fill_level(std::span<const Aabb> boxes, const GridLevel& level, std::span<const std::uint32_t> members,
                  std::vector<Element>& sorted, std::vector<Element>& other);
  void index_level(GridLevel& level);
  [[gnu::always_inline]] inline void store(const Aabb& box, std::uint32_t number, Key key, std::uint32_t place) {
    blocks[place / kBlock].set(place % kBlock, box);
    keys[place] = key;
    numbers[place] = number;
  }
  void pad(std::uint32_t from, std::uint32_t to);

  Extent all_;  // of every box in the last rebuild
  std::vector<std::int16_t> exponent_of_box_;
};

}  // namespace collided::engine::grid
