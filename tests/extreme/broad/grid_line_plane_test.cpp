// Everything on one line or in one plane: an extent of zero divides, and all cells of two axes are one.
#include <gtest/gtest.h>

#include "tests/extreme/broad/candidates.hpp"

namespace collided::engine::grid_line_plane_test {
namespace {

TEST(ExtremeGridLinePlane, PointsOnALine) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Aabb> boxes;
    for (int i = 0; i < 1'000; ++i) {
      Vec3 place = Vec3::Zero();
      place[axis] = i / 2;
      boxes.push_back({place, place});
    }
    const Grid grid = extreme::grid_of(boxes);
    EXPECT_EQ(extreme::count_pairs(grid), 500u) << "two at each place";
    Vec3 direction = Vec3::Zero();
    direction[axis] = 1;
    EXPECT_EQ(extreme::along_ray(grid, {Vec3::Zero(), direction}, 1e3).size(), 1'000u);
    EXPECT_EQ(extreme::along_ray(grid, {Vec3::Zero(), direction}, 99).size(), 200u);
  }
}

TEST(ExtremeGridLinePlane, SheetsInOnePlane) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Aabb> boxes;
    for (int i = 0; i < 900; ++i) {
      Vec3 low(0, 0, 0), size(1, 1, 1);
      low[(axis + 1) % 3] = i % 30;
      low[(axis + 2) % 3] = i / 30;
      size[axis] = 0;
      boxes.push_back({low, low + size});
    }
    // Each sheet and its neighbours: on a line 3n - 2 with itself, in the plane squared; without itself, halved.
    EXPECT_EQ(extreme::count_pairs(extreme::grid_of(boxes)), (88u * 88 - 900) / 2);
    Vec3 from(0.5, 0.5, 0.5), direction(0, 0, 0);
    from[axis] = -1;
    direction[axis] = 1;
    EXPECT_EQ(extreme::along_ray(extreme::grid_of(boxes), {from, direction}, 2).size(), 1u);
  }
}

TEST(ExtremeGridLinePlane, OneBoxAndNone) {
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of({})), 0u);
  EXPECT_TRUE(extreme::in_box(extreme::grid_of({}), extreme::cube({0, 0, 0}, 1)).empty());
  EXPECT_TRUE(extreme::along_ray(extreme::grid_of({}), {Vec3::Zero(), Vec3::UnitX()}, 1).empty());
  const Grid one = extreme::grid_of({Aabb{{1, 1, 1}, {1, 1, 1}}});
  EXPECT_EQ(extreme::count_pairs(one), 0u);
  EXPECT_EQ(extreme::in_box(one, {{1, 1, 1}, {1, 1, 1}}).size(), 1u);
}

}  // namespace
}  // namespace collided::engine::grid_line_plane_test
