// A hundred thousand shells around one point, each a step larger: every centre is equal and every pair overlaps, so no
// cut by centre or by cell parts them.
#include <gtest/gtest.h>

#include "tests/extreme/broad/candidates.hpp"

namespace collided::engine::grid_concentric_test {
namespace {

std::vector<Aabb> shells(int count) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < count; ++i) {
    const double radius = 1 + i * 0x1p-34;
    boxes.push_back({Vec3::Constant(-radius), Vec3::Constant(radius)});
  }
  return boxes;
}

TEST(ExtremeGridConcentric, TheSurfaceCutsOffExactlyTheSmallerShells) {
  const std::vector<Aabb> boxes = shells(100'000);
  const Grid grid = extreme::grid_of(boxes);
  for (const int first : {0, 1, 49'999, 99'999}) {
    const Vec3 on_the_shell(1 + first * 0x1p-34, 0, 0);
    EXPECT_EQ(extreme::in_box(grid, {on_the_shell, on_the_shell}).size(), 100'000u - first);
  }
  const Vec3 outside(1 + 100'000 * 0x1p-34, 0, 0);
  EXPECT_TRUE(extreme::in_box(grid, {outside, outside}).empty());
  EXPECT_LT(grid.bytes(), boxes.size() * 160) << "with the tree for rays";
  Grid for_pairs(Grid::Use::pairs);
  for_pairs.rebuild(boxes);
  EXPECT_LT(for_pairs.bytes(), boxes.size() * 120);
}

TEST(ExtremeGridConcentric, AllPairsOverlap) {
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(shells(5'000))), 12'497'500u);  // 5,000 * 4,999 / 2
}

// Shells that grow by half: each has a level of its own sooner or later.
TEST(ExtremeGridConcentric, OverManySizes) {
  std::vector<Aabb> boxes;
  double radius = 1e-150;
  for (int i = 0; i < 1'500; ++i, radius *= 1.5) boxes.push_back({Vec3::Constant(-radius), Vec3::Constant(radius)});
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(boxes)), 1'124'250u);  // 1,500 * 1,499 / 2
}

}  // namespace
}  // namespace collided::engine::grid_concentric_test
