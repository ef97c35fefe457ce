// Cells of live clouds: which one a point is in, which ones a ray crosses, and what scans make of them.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "client/library/voxels/cell_walk.hpp"
#include "collided/voxels.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/oracle/voxel_oracle.hpp"

namespace collided {
namespace {

using boost::multiprecision::cpp_rational;
using std::chrono::seconds;

VoxelGrid grid_of(const VoxelOptions& options) {
  Result<VoxelGrid> made = VoxelGrid::make(options);
  EXPECT_TRUE(made);
  return std::move(*made);
}

VoxelScan insert(VoxelGrid& grid, const std::vector<double>& points, const std::optional<Vec3>& origin = {},
                 std::chrono::nanoseconds time = seconds(1)) {
  return grid.insert(std::span<const double>(points), origin, time);
}

TEST(Voxels, APointIsInTheCellThatHoldsItExactly) {
  std::mt19937_64 random = oracle::seeded(25);
  std::uniform_real_distribution<double> spread(-40, 40), size(0.01, 0.5);
  for (int i = 0; i < 2'000; ++i) {
    const VoxelGrid grid = grid_of({.cell_m = size(random)});
    double x = spread(random);
    // Half of them on a border, or a bit beside it.
    if (i % 2 == 0) x = std::nearbyint(x / grid.cell_m()) * grid.cell_m();
    if (i % 4 == 0) x = std::nextafter(x, i % 8 == 0 ? 100 : -100);
    const std::optional<VoxelNumber> cell = grid.cell_of({x, 0, -x});
    ASSERT_TRUE(cell);
    const cpp_rational side(grid.cell_m());
    for (const auto& [number, at] : {std::pair{(*cell)[0], x}, std::pair{(*cell)[2], -x}}) {
      EXPECT_LE(number * side, cpp_rational(at));
      EXPECT_GT((number + 1) * side, cpp_rational(at));
    }
  }
}

TEST(Voxels, ARayCrossesTheCellsWhoseInsideItMeets) {
  std::mt19937_64 random = oracle::seeded(26);
  std::uniform_int_distribution<std::int64_t> unit(0, 31);
  std::uniform_int_distribution<std::int32_t> number(-9, 9), few(-1, 1);
  for (int i = 0; i < 240; ++i) {
    client::RayStart start;
    VoxelNumber end{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      start.cell[axis] = number(random);
      // In a third of them along diagonals, which meet edges and corners.
      start.units[axis] = i % 3 == 0 ? 31 : 2 * unit(random) + 1;
      end[axis] = i % 3 == 0 ? start.cell[axis] + 7 * few(random) : number(random);
    }
    std::array<cpp_rational, 3> from, to;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      from[axis] = start.cell[axis] + cpp_rational(start.units[axis], client::kUnitsPerCell);
      to[axis] = end[axis] + cpp_rational(1, 2);
    }
    std::set<VoxelNumber> crossed{end};
    std::vector<VoxelNumber> in_order;
    for (client::CellWalk walk(start, end); !walk.is_at_end(); walk.step()) {
      EXPECT_TRUE(crossed.insert(walk.cell()).second) << "once each";
      in_order.push_back(walk.cell());
    }
    in_order.push_back(end);
    EXPECT_EQ(crossed, oracle::cells_met(from, to));
    // Leaving a block goes to the first cell beyond it, as step by step.
    for (const std::int32_t side : {2, 4, 16}) {
      const auto block = [&](const VoxelNumber& cell) {
        return VoxelNumber{cell[0] & -side, cell[1] & -side, cell[2] & -side};
      };
      client::CellWalk walk(start, end);
      for (std::size_t at = 0; !walk.is_at_end();) {
        ASSERT_EQ(walk.cell(), in_order.at(at));
        walk.leave_block(side);
        const VoxelNumber left = block(in_order[at]);
        while (at + 1 < in_order.size() && block(in_order[at]) == left) ++at;
        if (walk.is_at_end()) { EXPECT_EQ(walk.cell(), end); }
      }
    }
  }
}

TEST(Voxels, TheLongestRayDoesNotOverflow) {
  const client::RayStart start{.cell = {0, 0, 0}, .units = {1, 63, 31}};
  const std::int32_t far = client::kLongestRayCells;
  std::size_t steps = 0;
  VoxelNumber last{};
  for (client::CellWalk walk(start, {far, -far, far}); !walk.is_at_end(); walk.step()) {
    ++steps;
    last = walk.cell();
  }
  EXPECT_GT(steps, static_cast<std::size_t>(far));
  EXPECT_LE(std::abs(last[0] - far) + std::abs(last[1] + far) + std::abs(last[2] - far), 3);
}

TEST(Voxels, TheOriginIsMovedByAtMostASixtyFourth) {
  std::mt19937_64 random = oracle::seeded(27);
  std::uniform_real_distribution<double> spread(-30, 30);
  const double cell_m = grid_of({}).cell_m();
  for (int i = 0; i < 2'000; ++i) {
    double x = spread(random);
    if (i % 3 == 0) x = std::nearbyint(x / cell_m) * cell_m;
    const std::optional<client::RayStart> start = client::ray_start({x, x, x}, cell_m);
    ASSERT_TRUE(start);
    const cpp_rational at = (start->cell[0] + cpp_rational(start->units[0], 64)) * cpp_rational(cell_m);
    // The place within the cell is a rounded difference, hence the last term.
    EXPECT_LE(abs(at - cpp_rational(x)), cpp_rational(cell_m) / 64 + cpp_rational(0x1p-45));
    EXPECT_EQ(start->units[0] % 2, 1);
  }
}

TEST(Voxels, AScanMakesCellsOccupiedAndWhatLiesBeforeThemFree) {
  VoxelGrid grid = grid_of({.cell_m = 0.5, .unknown = UnknownCells::undecided});
  const VoxelScan scan = insert(grid, {3.2, 0.2, 0.2, 3.3, 0.3, 0.3}, Vec3(0.2, 0.2, 0.2));
  EXPECT_EQ(scan.points, 2U);
  EXPECT_EQ(scan.occupied, 1U);
  EXPECT_EQ(scan.crossed, 6U);
  EXPECT_EQ(grid.state({6, 0, 0}), VoxelState::occupied);
  EXPECT_EQ(grid.state({5, 0, 0}), VoxelState::free);
  EXPECT_EQ(grid.state({0, 0, 0}), VoxelState::free);
  EXPECT_EQ(grid.state({7, 0, 0}), VoxelState::unknown);
  EXPECT_EQ(grid.state({3, 1, 0}), VoxelState::unknown);
  // What was seen once is gone after it was seen through three times: 0.85 - 3 * 0.4 < 0.
  for (int i = 0; i < 2; ++i) insert(grid, {5.2, 0.2, 0.2}, Vec3(0.2, 0.2, 0.2));
  EXPECT_EQ(grid.state({6, 0, 0}), VoxelState::occupied);
  insert(grid, {5.2, 0.2, 0.2}, Vec3(0.2, 0.2, 0.2));
  EXPECT_EQ(grid.state({6, 0, 0}), VoxelState::free);
}

TEST(Voxels, APointOfTheSameScanCountsMoreThanARayThroughItsCell) {
  VoxelGrid grid = grid_of({.cell_m = 1});
  for (int i = 0; i < 20; ++i) insert(grid, {3.5, 0.5, 0.5, 6.5, 0.5, 0.5}, Vec3(0.5, 0.5, 0.5));
  EXPECT_EQ(grid.state({3, 0, 0}), VoxelState::occupied);
  EXPECT_EQ(grid.state({6, 0, 0}), VoxelState::occupied);
}

TEST(Voxels, APointBeyondTheReachOnlyClears) {
  VoxelGrid grid = grid_of({.cell_m = 1, .unknown = UnknownCells::undecided, .reach_m = 4});
  const VoxelScan scan = insert(grid, {9.5, 0.5, 0.5}, Vec3(0.5, 0.5, 0.5));
  EXPECT_EQ(scan.far, 1U);
  EXPECT_EQ(scan.occupied, 0U);
  EXPECT_EQ(grid.state({4, 0, 0}), VoxelState::free);
  EXPECT_EQ(grid.state({5, 0, 0}), VoxelState::unknown);
  EXPECT_EQ(grid.state({9, 0, 0}), VoxelState::unknown);
}

TEST(Voxels, WhatNoScanMeetsDecays) {
  VoxelGrid grid = grid_of({.cell_m = 1, .unknown = UnknownCells::undecided, .decay = seconds(8)});
  insert(grid, {3.5, 0.5, 0.5}, Vec3(0.5, 0.5, 0.5), seconds(100));
  insert(grid, {20.5, 0.5, 0.5}, {}, seconds(104));
  EXPECT_EQ(grid.decay(seconds(108)), 0U) << "it is as old as is allowed";
  EXPECT_EQ(grid.state({3, 0, 0}), VoxelState::occupied);
  EXPECT_EQ(grid.decay(std::chrono::milliseconds(108'501)), 1U) << "a sixteenth later at the latest";
  EXPECT_EQ(grid.state({3, 0, 0}), VoxelState::unknown);
  EXPECT_EQ(grid.state({0, 0, 0}), VoxelState::unknown);
  EXPECT_EQ(grid.state({20, 0, 0}), VoxelState::occupied);
  EXPECT_EQ(grid.decay(seconds(5'000)), 1U) << "a pause longer than ticks are counted";
  EXPECT_EQ(grid.block_count(), 0U);
}

TEST(Voxels, WhatCannotBeAPointIsCounted) {
  VoxelGrid grid = grid_of({.cell_m = 0.05, .most_blocks = 1});
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const VoxelScan scan = insert(grid, {nan, 0, 0, 0, inf, 0, 0, 0, 1e300, 0.1, 0.1, 0.1, 5, 5, 5}, Vec3(nan, 0, 0));
  EXPECT_EQ(scan.refused, 3U);
  EXPECT_EQ(scan.points, 1U);
  EXPECT_EQ(scan.dropped, 1U);
  EXPECT_EQ(insert(grid, {nan, nan, nan, inf, inf, inf}, Vec3(0, 0, 0)).refused, 2U);
}

TEST(Voxels, OptionsOutOfRangeAreRefused) {
  EXPECT_FALSE(VoxelGrid::make({.cell_m = 0}));
  EXPECT_FALSE(VoxelGrid::make({.cell_m = std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_FALSE(VoxelGrid::make({.decay = seconds(-1)}));
  EXPECT_FALSE(VoxelGrid::make({.reach_m = 0}));
  EXPECT_FALSE(VoxelGrid::make({.most_blocks = 0}));
  EXPECT_EQ(grid_of({.cell_m = 0.05}).cell_m(), 0.05000000074505806);
  EXPECT_EQ(grid_of({.cell_m = 0.25}).cell_m(), 0.25);
}

TEST(Voxels, AMapSetsWhatItNamesAndForgetsTheRest) {
  VoxelGrid grid = grid_of({.cell_m = 1, .unknown = UnknownCells::undecided});
  insert(grid, {40.5, 0.5, 0.5});
  const std::vector<VoxelBlock> map{{.low = {-4, -4, -4}, .side = 8, .state = VoxelState::free},
                                    {.low = {4, 0, 0}, .side = 2, .state = VoxelState::occupied},
                                    {.low = {0, 0, 0}, .side = 0, .state = VoxelState::occupied}};
  const VoxelScan scan = grid.assign(map, seconds(1));
  EXPECT_EQ(scan.refused, 1U);
  EXPECT_EQ(scan.crossed, 512U);
  EXPECT_EQ(scan.occupied, 8U);
  EXPECT_EQ(grid.state({-4, 3, 0}), VoxelState::free);
  EXPECT_EQ(grid.state({5, 1, 1}), VoxelState::occupied);
  EXPECT_EQ(grid.state({40, 0, 0}), VoxelState::unknown);
  EXPECT_EQ(grid.occupied_count(), 8U);
}

}  // namespace
}  // namespace collided
