// A ray through the corners of cells leaves by two or three faces at once: a walk that takes one may skip the cell
// behind the other or see one twice.
#include <gtest/gtest.h>

#include "server/broad_phase/grid/grid_levels.hpp"
#include "tests/extreme/broad/candidates.hpp"

namespace collided::engine::grid_lattice_ray_test {
namespace {

/// Unit cubes on all points of an 8^3 lattice, sharing faces.
std::vector<Aabb> lattice(const Vec3& origin) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 512; ++i) boxes.push_back(extreme::cube(origin + Vec3(i % 8, i / 8 % 8, i / 64), 1));
  return boxes;
}

TEST(ExtremeGridLatticeRay, ThroughEveryCornerOfTheDiagonal) {
  for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(-4, -4, -4), Vec3(1e6, -1e6, 1e6)}) {
    const Grid grid = extreme::grid_of(lattice(origin));
    const extreme::Numbers seen = extreme::along_ray(grid, {origin - Vec3(1, 1, 1), {1, 1, 1}}, 99);
    // At each of the 7 inner corners 8 cubes meet: the diagonal touches 8 on its way and 6 more at each corner.
    EXPECT_GE(seen.size(), 8u + 7 * 6);
    EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end()) << "each once";
    for (std::uint32_t k = 0; k < 8; ++k) EXPECT_TRUE(std::binary_search(seen.begin(), seen.end(), k * 73));
  }
}

TEST(ExtremeGridLatticeRay, AlongTheEdgeThatFourCellsShare) {
  for (const double zero : {0.0, -0.0}) {
    const Grid grid = extreme::grid_of(lattice({-4, -4, -4}));
    const extreme::Numbers seen = extreme::along_ray(grid, {{-9, zero, -zero}, {1, zero, zero}}, 99);
    EXPECT_EQ(seen.size(), 32u) << "four rows of eight";
    const extreme::Numbers back = extreme::along_ray(grid, {{9, zero, -zero}, {-0x1p-1000, -zero, zero}}, 0x1p1010);
    EXPECT_EQ(back, seen);
  }
}

TEST(ExtremeGridLatticeRay, WithinAPlaneOfCellBorders) {
  const Grid grid = extreme::grid_of(lattice({-4, -4, -4}));
  // y = x in the plane z = 0: 8 cubes on the way and 2 more at each of 7 corners, on both sides of the plane.
  const extreme::Numbers seen = extreme::along_ray(grid, {{-5, -5, 0}, {1, 1, 0}}, 99);
  EXPECT_EQ(seen.size(), 2u * (8 + 7 * 2));
}

// The grid's own borders: each cube begins in the corner of its cell, and the ray passes through all those corners.
TEST(ExtremeGridLatticeRay, ThroughTheCornersOfTheGridsOwnCells) {
  grid::Levels levels;
  grid::RebuildScratch scratch;
  levels.rebuild(lattice({0, 0, 0}), false, scratch);
  const double cell_m = levels.levels.at(0).cell_m[0];
  for (const double first : {0.0, -4.0, -8.0}) {
    std::vector<Aabb> boxes;
    for (int i = 0; i < 512; ++i) {
      boxes.push_back(extreme::cube(cell_m * (Vec3::Constant(first) + Vec3(i % 8, i / 8 % 8, i / 64)), 1));
    }
    const Grid grid = extreme::grid_of(boxes);
    for (const double sign : {1.0, -1.0}) {
      const Ray ray{Vec3::Constant(-sign * 16 * cell_m), Vec3::Constant(sign * cell_m)};
      const extreme::Numbers seen = extreme::along_ray(grid, ray, 99);
      EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end()) << "each once";
      for (std::uint32_t k = 0; k < 8; ++k) EXPECT_TRUE(std::binary_search(seen.begin(), seen.end(), k * 73)) << first;
    }
  }
}

TEST(ExtremeGridLatticeRay, TheLimitOnABorderTouchesTheNextCell) {
  const Grid grid = extreme::grid_of(lattice({-4, -4, -4}));
  const Ray ray{{-5, 0.5, 0.5}, {1, 0, 0}};
  EXPECT_EQ(extreme::along_ray(grid, ray, 4).size(), 4u) << "x = -4 .. -1 in three cubes, and the fourth is touched";
  EXPECT_GE(extreme::along_ray(grid, ray, 1).size(), 1u);
}

}  // namespace
}  // namespace collided::engine::grid_lattice_ray_test
