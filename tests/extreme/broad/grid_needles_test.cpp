// Needles and plates: long on one axis or two, so that a cube of a cell holds thousands of them that are apart.
#include <gtest/gtest.h>

#include "tests/extreme/broad/candidates.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::grid_needles_test {
namespace {

std::vector<Aabb> bundle(int axis, int side, double pitch) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < side * side; ++i) {
    Vec3 low = Vec3::Zero();
    low[(axis + 1) % 3] = pitch * (i % side);
    low[(axis + 2) % 3] = pitch * (i / side);
    Vec3 extent = Vec3::Constant(pitch / 2);
    extent[axis] = 1;
    boxes.push_back({low, low + extent});
  }
  return boxes;
}

// A cube of a cell for all would be five billion comparisons.
TEST(ExtremeGridNeedles, ABundleApartEndsAtOnceAndCompletely) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<Aabb> boxes = bundle(axis, 316, 0x1p-8);
    const Grid grid = extreme::grid_of(boxes);
    EXPECT_EQ(extreme::count_pairs(grid), 0u);
    EXPECT_EQ(extreme::in_box(grid, {Vec3::Constant(-1), Vec3::Constant(2)}).size(), boxes.size());
    for (std::uint32_t i = 0; i < boxes.size(); i += 997) {
      EXPECT_EQ(extreme::in_box(grid, boxes[i]), extreme::Numbers{i});
    }
  }
}

TEST(ExtremeGridNeedles, AcrossEachOtherEqualBruteForce) {
  std::mt19937_64 random = oracle::seeded(81);
  std::uniform_real_distribution<double> place(-1, 1);
  for (const double thickness : {0.0, 0x1p-30, 0x1p-6, 0.1}) {
    std::vector<Aabb> boxes;
    for (int i = 0; i < 1500; ++i) {
      const double x = place(random);
      const double y = place(random);
      const Vec3 low(x, y, place(random));
      Vec3 extent = i % 2 == 0 ? Vec3(Vec3::Constant(thickness)) : Vec3(Vec3::Constant(0.3));
      extent[i % 3] = i % 2 == 0 ? 0.7 : thickness;
      boxes.push_back({low, low + extent});
    }
    const Grid grid = extreme::grid_of(boxes);
    EXPECT_EQ(extreme::pairs_of(grid), extreme::pairs_by_force(boxes));
    for (std::uint32_t i = 0; i < 100; ++i) {
      extreme::Numbers expected;
      for (std::uint32_t other = 0; other < boxes.size(); ++other) {
        if (overlaps(boxes[i], boxes[other])) expected.push_back(other);
      }
      EXPECT_EQ(extreme::in_box(grid, boxes[i]), expected);
    }
  }
}

TEST(ExtremeGridNeedles, PairsEndWhenTold) {
  const Grid grid = extreme::grid_of(std::vector<Aabb>(100'000, extreme::cube({1, 2, 3}, 0.5)));
  WalkCost cost;
  int calls = 0;
  const auto ten = [&](std::uint32_t, std::uint32_t) { return ++calls < 10; };
  grid.pairs(ten, cost);
  EXPECT_EQ(calls, 10);
}

}  // namespace
}  // namespace collided::engine::grid_needles_test
