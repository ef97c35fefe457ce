// Cells chosen so that their hashes collide: one long chain in the table, where a walk that stops at the first
// foreign row, or takes it for its own, loses boxes.
#include <gtest/gtest.h>

#include "server/broad_phase/grid_levels.hpp"
#include "tests/extreme/candidates.hpp"

namespace collided {
namespace {

/// The first `count` cells (y, 0) whose hash ends in `low_bits` zeros: in any table of at most so many slots, one slot.
std::vector<grid::Cell> colliding_cells(std::size_t count, int low_bits) {
  grid::Level level;
  level.slot_mask = (1u << low_bits) - 1;
  std::vector<grid::Cell> cells;
  for (grid::Cell y = -(grid::Cell{1} << 38); cells.size() < count; ++y) {
    if (level.slot_of(y, 0) == 0) cells.push_back(y);
  }
  return cells;
}

constexpr double kSize = 0.75;

/// The side of a cell for boxes of kSize.
double cell_side() {
  grid::Levels levels;
  levels.rebuild(std::vector<Aabb>(100, extreme::cube({0, 0, 0}, kSize)));
  return levels.levels.at(0).cell_m;
}

TEST(ExtremeGridHashCollision, EveryBoxIsStillFoundAndInBoundedTime) {
  constexpr std::size_t kCount = 4'000;
  std::vector<Aabb> boxes;
  for (const grid::Cell y : colliding_cells(kCount, 14)) {
    boxes.push_back(extreme::cube({0, (static_cast<double>(y) + 0.125) * cell_side(), 0}, kSize));
  }
  grid::Levels levels;
  levels.rebuild(boxes);
  ASSERT_EQ(levels.levels.size(), 1u);
  std::size_t in_slot_0 = 0;
  for (const grid::Row& row : levels.rows) in_slot_0 += levels.levels[0].slot_of(row.y, row.z) == 0 ? 1 : 0;
  ASSERT_GT(in_slot_0, kCount * 9 / 10) << "the scene must be worth testing";

  const Grid grid = extreme::grid_of(boxes);
  EXPECT_TRUE(extreme::pairs_of(grid).empty());
  for (std::uint32_t i = 0; i < boxes.size(); i += 7) ASSERT_EQ(extreme::in_box(grid, boxes[i]), extreme::Numbers{i});
  // The same boxes twice: each meets its double and nobody else.
  std::vector<Aabb> twice = boxes;
  twice.insert(twice.end(), boxes.begin(), boxes.end());
  const extreme::Pairs pairs = extreme::pairs_of(extreme::grid_of(twice));
  ASSERT_EQ(pairs.size(), kCount);
  for (const auto& [a, b] : pairs) ASSERT_EQ(b, a + kCount);
}

}  // namespace
}  // namespace collided
