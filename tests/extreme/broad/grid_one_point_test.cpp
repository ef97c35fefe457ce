// A hundred thousand boxes in one cell: a grid degenerates to all pairs, which must cost time alone, never memory.
#include <gtest/gtest.h>

#include "tests/extreme/broad/candidates.hpp"

namespace collided::engine::grid_one_point_test {
namespace {

TEST(ExtremeGridOnePoint, AHundredThousandCostNoMemoryOfPairs) {
  const std::vector<Aabb> boxes(100'000, extreme::cube({1, 2, 3}, 0.5));
  const Grid grid = extreme::grid_of(boxes);
  EXPECT_LT(grid.bytes(), boxes.size() * 160) << "with the tree for rays";
  Grid for_pairs(Grid::Use::pairs);
  for_pairs.rebuild(boxes);
  EXPECT_LT(for_pairs.bytes(), boxes.size() * 120);
  EXPECT_EQ(extreme::in_box(grid, extreme::cube({1, 2, 3}, 0.5)).size(), 100'000u);
  EXPECT_EQ(extreme::in_box(grid, extreme::cube({1.5, 2.5, 3.5}, 1)).size(), 100'000u) << "touching";
  EXPECT_TRUE(extreme::in_box(grid, extreme::cube({1.5 + 0x1p-52, 2, 3}, 1)).empty());
  EXPECT_EQ(extreme::along_ray(grid, {{1.25, 2.25, 0}, {0, 0, 1}}, 9).size(), 100'000u);
  EXPECT_EQ(extreme::near_point(grid, {1, 2, 0}, 3).size(), 100'000u);
}

TEST(ExtremeGridOnePoint, TheFirstAnswerEndsTheWalk) {
  const Grid grid = extreme::grid_of(std::vector<Aabb>(100'000, extreme::cube({1, 2, 3}, 0.5)));
  WalkCost cost;
  int calls = 0;
  grid.walk_box(
      extreme::cube({1, 2, 3}, 0.5),
      [&](std::uint32_t) {
        ++calls;
        return false;
      },
      cost);
  EXPECT_EQ(calls, 1);
}

// 10,000 * 9,999 / 2, each pair once.
TEST(ExtremeGridOnePoint, PairsAreCountedOnceEach) {
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(std::vector<Aabb>(10'000, extreme::cube({1, 2, 3}, 0.5)))),
            49'995'000u);
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(std::vector<Aabb>(10'000, Aabb{{1, 2, 3}, {1, 2, 3}}))), 49'995'000u)
      << "boxes that are points";
}

}  // namespace
}  // namespace collided::engine::grid_one_point_test
