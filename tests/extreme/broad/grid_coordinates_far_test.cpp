// Unit objects at 1e12 m: a cell number is past 32 bits, and a coordinate times 1/cell has lost its fraction.
#include <gtest/gtest.h>

#include "tests/extreme/broad/candidates.hpp"

namespace collided::engine::grid_coordinates_far_test {
namespace {

/// Unit cubes in a row along the diagonal, one in two touching its successor at a corner.
std::vector<Aabb> pairs_on_the_diagonal(double offset) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 100; ++i) {
    const double start = 4.0 * (i / 2) + i % 2;
    boxes.push_back(extreme::cube(Vec3(offset + start, -offset - start, offset + start), 1));
  }
  return boxes;
}

TEST(ExtremeGridFar, NeighboursTouchAndOthersDoNot) {
  for (const double offset : {0.0, 1e6, 1e8, 1e12, 1e15}) {
    const std::vector<Aabb> boxes = pairs_on_the_diagonal(offset);
    const extreme::Pairs pairs = extreme::pairs_of(extreme::grid_of(boxes));
    ASSERT_EQ(pairs.size(), 50u) << offset;
    for (std::uint32_t i = 0; i < 50; ++i)
      EXPECT_EQ(pairs[i], (std::pair<std::uint32_t, std::uint32_t>(2 * i, 2 * i + 1)));
  }
}

TEST(ExtremeGridFar, WhereAUnitIsLostInTheCoordinateTheyAreOnePoint) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 40; ++i) boxes.push_back(extreme::cube(Vec3::Constant(1e300 + i), 1));
  EXPECT_EQ(extreme::pairs_of(extreme::grid_of(boxes)).size(), 780u) << "40 * 39 / 2";
}

TEST(ExtremeGridFar, NearAndFarInOneGrid) {
  std::vector<Aabb> boxes;
  for (const double offset : {0.0, 1e6, -1e12, 1e18, -1e100, 1e307}) {
    boxes.push_back(extreme::cube(Vec3::Constant(offset), 1));
    boxes.push_back(extreme::cube(Vec3::Constant(offset), 1));
  }
  EXPECT_EQ(extreme::pairs_of(extreme::grid_of(boxes)).size(), 6u);
  EXPECT_EQ(extreme::along_ray(extreme::grid_of(boxes), {Vec3::Constant(-1e13), {1, 1, 1}}, 1e14).size(), 6u)
      << "from -1e13 for 1e14: those at -1e12, 0 and 1e6";
}

}  // namespace
}  // namespace collided::engine::grid_coordinates_far_test
