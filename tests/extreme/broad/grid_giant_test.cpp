// A53: one box a trillion grains wide: a grid of one cell size either floods cells with the giant or puts all dust in one.
#include <gtest/gtest.h>

#include "tests/extreme/broad/candidates.hpp"

namespace collided::engine::grid_giant_test {
namespace {

/// 32^3 grains of a millimetre in a lattice of 2 m: none touches another.
std::vector<Aabb> dust() {
  std::vector<Aabb> grains;
  for (int i = 0; i < 32 * 32 * 32; ++i) {
    grains.push_back(extreme::cube(2.0 * Vec3(i % 32 - 16, i / 32 % 32 - 16, i / 1024 - 16), 0x1p-10));
  }
  return grains;
}

TEST(ExtremeGridGiant, PairsAreTheGrainsItHolds) {
  std::vector<Aabb> boxes = dust();
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(boxes)), 0u);
  const auto giant = static_cast<std::uint32_t>(boxes.size());
  boxes.push_back(extreme::cube({-1e9, -1e9, 0}, 2e9));  // half of the dust: z >= 0
  const Grid grid = extreme::grid_of(boxes);
  const extreme::Pairs pairs = extreme::pairs_of(grid);
  EXPECT_EQ(pairs.size(), 32u * 32 * 16);
  for (const auto& [a, b] : pairs) {
    ASSERT_EQ(b, giant);
    ASSERT_GE(boxes[a].high.z(), 0);
  }
  EXPECT_LT(grid.bytes(), boxes.size() * 200) << "no cells for the giant";
}

TEST(ExtremeGridGiant, SmallQuestionsStaySmall) {
  std::vector<Aabb> boxes = dust();
  boxes.push_back(extreme::cube({-1e9, -1e9, -1e9}, 2e9));
  const Grid grid = extreme::grid_of(boxes);
  WalkCost cost;
  const auto see = [](std::uint32_t) { return true; };
  grid.walk_box(extreme::cube({2, 2, 2}, 0x1p-12), see, cost);
  EXPECT_LT(cost.nodes + cost.candidates, 100u);
  EXPECT_EQ(extreme::in_box(grid, extreme::cube({2, 2, 2}, 0x1p-12)).size(), 2u) << "a grain and the giant";
}

TEST(ExtremeGridGiant, GiantsOfEveryDecadeAtOnce) {
  std::vector<Aabb> boxes;
  for (int decade = -300; decade <= 300; decade += 3) {
    const double half = std::pow(10.0, decade);
    boxes.push_back({Vec3::Constant(-half), Vec3::Constant(half)});
  }
  const auto n = static_cast<std::uint64_t>(boxes.size());
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(boxes)), n * (n - 1) / 2) << "all hold the origin";
  EXPECT_EQ(extreme::in_box(extreme::grid_of(boxes), {Vec3::Zero(), Vec3::Zero()}).size(), n);
  // From 2e0 on only those of 10^3 and more reach.
  EXPECT_EQ(extreme::in_box(extreme::grid_of(boxes), {Vec3::Constant(2), Vec3::Constant(2)}).size(), 100u);
}

}  // namespace
}  // namespace collided::engine::grid_giant_test
