// A55: rows crowded into one bucket of the grid's directory by boxes far away: a search that looks at a bucket from end to
// end takes the square of the rows, and one that stops at a foreign row loses boxes.
#include <gtest/gtest.h>

#include "server/broad_phase/grid/grid_levels.hpp"
#include "tests/extreme/broad/candidates.hpp"

namespace collided::engine::grid_one_bucket_test {
namespace {

constexpr double kSize = 0.75;

/// One box in each of `count` rows side by side, and one so far out that its bucket spans them all.
std::vector<Aabb> rows_and_one_far(std::size_t count) {
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) boxes.push_back(extreme::cube({0, static_cast<double>(i), 0}, kSize));
  boxes.push_back(extreme::cube({0, 0, 0x1p38}, kSize));
  return boxes;
}

TEST(ExtremeGridOneBucket, EveryBoxIsStillFoundAndInBoundedTime) {
  constexpr std::size_t kCount = 200'000;
  const std::vector<Aabb> boxes = rows_and_one_far(kCount);
  grid::Levels levels;
  grid::RebuildScratch scratch;
  levels.rebuild(boxes, false, scratch);
  ASSERT_EQ(levels.levels.size(), 1u);
  const grid::GridLevel& level = levels.levels[0];
  ASSERT_EQ(levels.keys[level.begin + kCount - 1] >> level.bucket_shift, 0u) << "the scene must be worth testing";

  const Grid grid = extreme::grid_of(boxes);
  EXPECT_TRUE(extreme::pairs_of(grid).empty());
  for (std::uint32_t i = 0; i < boxes.size(); ++i) ASSERT_EQ(extreme::in_box(grid, boxes[i]), extreme::Numbers{i});
  // The same boxes twice: each meets its double and nobody else.
  std::vector<Aabb> twice = boxes;
  twice.insert(twice.end(), boxes.begin(), boxes.end());
  const extreme::Pairs pairs = extreme::pairs_of(extreme::grid_of(twice));
  ASSERT_EQ(pairs.size(), boxes.size());
  for (const auto& [a, b] : pairs) ASSERT_EQ(b, a + boxes.size());
}

// Forty binary digits an axis are more than a key has: cells that nothing occupies are then left out of the count.
TEST(ExtremeGridOneBucket, AWorldTooWideForItsKeysLosesNothing) {
  std::vector<Aabb> boxes;
  const double far[] = {0, 1, 2, 3, 0x1p20, 0x1p20 + 1, 0x1p37, 0x1p37 + 1, 0x1p38};
  for (const double x : far) {
    for (const double y : far) {
      for (const double z : far) boxes.push_back(extreme::cube({x, y, -z}, 1));
    }
  }
  grid::Levels levels;
  grid::RebuildScratch scratch;
  levels.rebuild(boxes, false, scratch);
  ASSERT_EQ(levels.levels.size(), 1u);
  ASSERT_GT(levels.levels[0].axes[0].bytes(), 0u) << "the scene must be worth testing";
  const Grid grid = extreme::grid_of(boxes);
  EXPECT_EQ(extreme::pairs_of(grid), extreme::pairs_by_force(boxes));
  for (const Aabb& asked : boxes) {
    extreme::Numbers expected;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      if (overlaps(boxes[i], asked)) expected.push_back(i);
    }
    ASSERT_EQ(extreme::in_box(grid, asked), expected);
    // The floats of a tree over a world this wide do not tell neighbours apart: what is there is among what it offers.
    const extreme::Numbers there = extreme::in_box(grid, {asked.low, asked.low});
    const extreme::Numbers near = extreme::near_point(grid, asked.low, 0);
    ASSERT_TRUE(std::includes(near.begin(), near.end(), there.begin(), there.end()));
  }
}

}  // namespace
}  // namespace collided::engine::grid_one_bucket_test
