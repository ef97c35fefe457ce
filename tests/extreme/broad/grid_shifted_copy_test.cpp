// A lattice of cubes laid on itself, shifted by one cell and by one rounding more or less: the number of touching pairs
// is known to the pair, and jumps.
#include <gtest/gtest.h>

#include "tests/extreme/broad/candidates.hpp"

namespace collided::engine::grid_shifted_copy_test {
namespace {

constexpr int kSide = 8;

/// Unit cubes at even places of a lattice, so that they are apart among themselves, and a copy moved along x.
std::vector<Aabb> lattice_and_copy(double spacing, double shift) {
  std::vector<Aabb> boxes;
  for (const double by : {0.0, shift}) {
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
      const Vec3 low = spacing * Vec3(i % kSide, i / kSide % kSide, i / kSide / kSide);
      boxes.push_back({low + Vec3(by, 0, 0), low + Vec3(by + 1, 1, 1)});
    }
  }
  return boxes;
}

TEST(ExtremeGridShiftedCopy, CubesApartTouchOnlyTheirCopies) {
  constexpr std::uint64_t kCubes = kSide * kSide * kSide;
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(lattice_and_copy(4, 0))), kCubes);
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(lattice_and_copy(4, 1 - 0x1p-53))), kCubes);
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(lattice_and_copy(4, 1))), kCubes) << "faces touch";
  // One step beyond, only the column at x = 0 can tell: 28 + 2^-52 is 28 again, and there the copies touch still.
  const std::vector<Aabb> beyond = lattice_and_copy(4, 1 + 0x1p-52);
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(beyond)), kCubes - kSide * kSide);
  EXPECT_EQ(extreme::pairs_of(extreme::grid_of(beyond)), extreme::pairs_by_force(beyond));
}

TEST(ExtremeGridShiftedCopy, CubesWithoutGapsTouchTheirNeighbours) {
  // On a line of n cubes each touches itself and its neighbours in the copy: 3n - 2; in space that cubed.
  constexpr std::uint64_t kBetween = 22 * 22 * 22;
  // Within one lattice: ordered neighbour pairs (3n - 2)^3 without the cube itself, halved.
  constexpr std::uint64_t kWithin = (kBetween - 512) / 2;
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(lattice_and_copy(1, 0))), kBetween + 2 * kWithin);
  // Moved by one: along x a cube meets three of the copy's, less at the ends: sum over shifts 0, 1, 2 of n - |shift|
  // on the touching side is 8 + 7 + 6 and 7 on the far side that now coincides.
  const std::vector<Aabb> moved = lattice_and_copy(1, 1);
  EXPECT_EQ(extreme::count_pairs(extreme::grid_of(moved)), (8u + 7 + 6) * 22 * 22 + 2 * kWithin);
}

}  // namespace
}  // namespace collided::engine::grid_shifted_copy_test
