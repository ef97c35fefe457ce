// A corner exactly on a cell border belongs to both cells; truncation toward zero folds -0.5 and 0.5 into one.
#include <gtest/gtest.h>

#include "server/broad_phase/grid/grid_levels.hpp"
#include "tests/extreme/broad/candidates.hpp"

namespace collided::engine::grid_cell_border_test {
namespace {

constexpr double kTiniest = 0x1p-1074;

TEST(ExtremeGridCellBorder, BoxesThatShareACornerOnABorderMeet) {
  for (const double size : {0x1p-20, 0.5, 1.0, 0x1p20}) {
    for (const double place : {-2.0, -1.0, -0.0, 0.0, 1.0, 2.0}) {
      std::vector<Aabb> boxes;
      for (int octant = 0; octant < 8; ++octant) {
        const Vec3 low(octant & 1 ? place * size : (place - 1) * size, octant & 2 ? place * size : (place - 1) * size,
                       octant & 4 ? place * size : (place - 1) * size);
        boxes.push_back(extreme::cube(low, size));
      }
      ASSERT_EQ(extreme::pairs_of(extreme::grid_of(boxes)).size(), 28u) << "8 boxes around one corner, " << size;
      const Vec3 corner = Vec3::Constant(place * size);
      ASSERT_EQ(extreme::in_box(extreme::grid_of(boxes), {corner, corner}).size(), 8u);
      ASSERT_EQ(extreme::near_point(extreme::grid_of(boxes), corner, 0).size(), 8u);
    }
  }
}

TEST(ExtremeGridCellBorder, ZerosOfBothSignsAndDenormalsAreOnePlace) {
  std::vector<Aabb> boxes;
  for (const double x : {-0.0, 0.0, kTiniest, -kTiniest}) {
    for (const double y : {-0.0, 0.0, kTiniest, -kTiniest}) boxes.push_back({{x, y, -0.0}, {x, y, 0.0}});
  }
  for (int i = 0; i < 40; ++i) boxes.push_back(extreme::cube({3.0 * i + 3, 0, 0}, 1));  // so that there is a level
  EXPECT_EQ(extreme::pairs_of(extreme::grid_of(boxes)), extreme::pairs_by_force(boxes));
  EXPECT_EQ(extreme::in_box(extreme::grid_of(boxes), {{0, 0, 0}, {0, 0, 0}}).size(), 4u);
  EXPECT_EQ(extreme::in_box(extreme::grid_of(boxes), {{-0.0, -0.0, -0.0}, {kTiniest, kTiniest, 0}}).size(), 9u);
}

TEST(ExtremeGridCellBorder, OneStepBesideTheBorderParts) {
  for (const double border : {-64.0, -1.0, 1.0, 64.0, 0x1p30}) {
    const std::vector<Aabb> touching{{{border - 1, 0, 0}, {border, 1, 1}}, {{border, 0, 0}, {border + 1, 1, 1}}};
    EXPECT_EQ(extreme::pairs_of(extreme::grid_of(touching)).size(), 1u);
    const double summand = std::nextafter(border, std::numeric_limits<double>::infinity());
    const std::vector<Aabb> apart{{{border - 1, 0, 0}, {border, 1, 1}}, {{summand, 0, 0}, {border + 1, 1, 1}}};
    EXPECT_TRUE(extreme::pairs_of(extreme::grid_of(apart)).empty()) << border;
  }
}

// The grid's own borders, on both sides of zero, and one step on either side of each.
TEST(ExtremeGridCellBorder, CornersOnTheGridsOwnBordersAreFoundFromBothSides) {
  grid::Levels levels;
  grid::RebuildScratch scratch;
  levels.rebuild(std::vector<Aabb>(100, extreme::cube({0, 0, 0}, 1)), false, scratch);
  const double cell_m = levels.levels.at(0).cell_m[0];
  std::vector<Aabb> boxes;
  for (int i = 0; i < 7 * 7 * 27; ++i) {
    Vec3 low = cell_m * Vec3(i % 7 - 3, i / 7 % 7 - 3, 0);
    const int steps[3] = {i / 49 % 3, i / 147 % 3, i / 441};
    for (int axis = 0; axis < 3; ++axis) {
      if (steps[axis] == 1) low[axis] = std::nextafter(low[axis], -1e9);
      if (steps[axis] == 2) low[axis] = std::nextafter(low[axis], 1e9);
    }
    boxes.push_back(extreme::cube(low, 1));
  }
  EXPECT_EQ(extreme::pairs_of(extreme::grid_of(boxes)), extreme::pairs_by_force(boxes));
  for (int i = -3; i <= 3; ++i) {
    const Vec3 border(i * cell_m, i * cell_m, 0);
    extreme::Numbers expected;
    for (std::uint32_t k = 0; k < boxes.size(); ++k) {
      if (overlaps(boxes[k], {border, border})) expected.push_back(k);
    }
    EXPECT_EQ(extreme::in_box(extreme::grid_of(boxes), {border, border}), expected) << i;
  }
}

}  // namespace
}  // namespace collided::engine::grid_cell_border_test
