// Cells of live clouds: which one a point is in, which ones a ray crosses, and what scans make of them.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "client/library/voxels/cell_ray.hpp"
#include "client/library/voxels/tile_table.hpp"
#include "collided/voxels.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/oracle/voxel_grid_oracle.hpp"
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

/// The place within 2^10 of 0 whose number it is.
constexpr client::BlockNumbering kNumbering{.origin = 0, .x = 1, .y = 1 << 10, .z = 1 << 20};
std::int64_t number_of(const VoxelNumber& place) {
  return place[0] * kNumbering.x + place[1] * kNumbering.y + place[2] * kNumbering.z;
}

/// The blocks that a ray meets from a time on, and when it comes to each.
template <int kBits>
std::vector<std::pair<std::int64_t, std::int64_t>> blocks_met(const client::CellRay& ray, std::int64_t from) {
  std::vector<std::pair<std::int64_t, std::int64_t>> met;
  for (client::BlockWalk<kBits> walk(ray, from, kNumbering);; walk.step()) {
    met.emplace_back(walk.at(), from);
    if (walk.leaves() >= ray.end) return met;
    from = walk.leaves();
  }
}

/// What a walk by blocks is to meet, from the cells in order.
template <int kBits>
void expect_same_blocks(const client::CellRay& ray, const std::vector<VoxelNumber>& cells) {
  std::vector<std::int64_t> wanted, met;
  for (const VoxelNumber& cell : cells) {
    const std::int64_t block = number_of({cell[0] >> kBits, cell[1] >> kBits, cell[2] >> kBits});
    if (wanted.empty() || wanted.back() != block) wanted.push_back(block);
  }
  const auto walked = blocks_met<kBits>(ray, 0);
  for (const auto& [block, time] : walked) met.push_back(block);
  EXPECT_EQ(met, wanted) << "blocks of " << (1 << kBits);
  // Begun within, it goes on as it would have.
  for (std::size_t i = 0; i < walked.size(); ++i)
    EXPECT_EQ(blocks_met<kBits>(ray, walked[i].second),
              std::vector(walked.begin() + static_cast<long>(i), walked.end()));
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
    const std::set<VoxelNumber> wanted = oracle::cells_met(from, to);
    const client::CellRay ray(start, end);
    std::set<std::int64_t> wanted_numbers, met;
    for (const VoxelNumber& cell : wanted) wanted_numbers.insert(number_of(cell));
    const auto walked = blocks_met<0>(ray, 0);
    for (const auto& [cell, time] : walked) EXPECT_TRUE(met.insert(cell).second) << "once each";
    EXPECT_EQ(met, wanted_numbers);
    EXPECT_EQ(walked.back().first, number_of(end));
    std::vector<VoxelNumber> in_order;
    for (const auto& [cell, time] : walked)
      in_order.push_back(*std::find_if(wanted.begin(), wanted.end(),
                                       [&, at = cell](const VoxelNumber& one) { return number_of(one) == at; }));
    expect_same_blocks<0>(ray, in_order);
    expect_same_blocks<1>(ray, in_order);
    expect_same_blocks<2>(ray, in_order);
    expect_same_blocks<4>(ray, in_order);
  }
}

TEST(Voxels, TheLongestRayDoesNotOverflow) {
  const client::RayStart start{.cell = {0, 0, 0}, .units = {1, 63, 31}};
  const std::int32_t far = client::kLongestRayCells;
  for (const VoxelNumber& end : {VoxelNumber{far, -far, far}, VoxelNumber{-far, far, -far}, VoxelNumber{far, 0, 1}}) {
    const client::CellRay ray(start, end);
    const client::BlockNumbering by = client::TileTable::kKeys;
    std::size_t steps = 0;
    std::int64_t time = 0;
    client::BlockWalk<0> walk(ray, 0, by);
    for (; walk.leaves() < ray.end; walk.step()) {
      ASSERT_GT(walk.leaves(), time);
      time = walk.leaves();
      // One in a thousand is as one that begins there.
      if (++steps % 1'000 == 0) { ASSERT_GT(client::BlockWalk<0>(ray, time, by).leaves(), time); }
    }
    EXPECT_GE(steps, static_cast<std::size_t>(far));
    EXPECT_EQ(client::TileTable::place_of(walk.at()), end);
  }
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

/// Scans from a sensor that moves about between a few walls, so that blocks are met again and again.
void expect_as_plain(UnknownCells unknown, std::uint64_t seed, const std::optional<std::chrono::nanoseconds>& decay) {
  std::mt19937_64 random = oracle::seeded(seed);
  const VoxelOptions options{.cell_m = 1, .unknown = unknown, .decay = decay.value_or(seconds(0))};
  VoxelGrid grid = grid_of(options);
  oracle::PlainGrid plain(options);
  std::uniform_int_distribution<int> in_room(-8, 8), near(-2, 2), wall(11, 13), one_of(0, 5), unit(0, 31);
  for (int scan = 0; scan < 30; ++scan) {
    std::array<std::int64_t, 3> sensor_64ths{};
    Vec3 origin;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sensor_64ths[axis] = 64 * near(random) + 2 * unit(random) + 1;
      origin[static_cast<int>(axis)] = static_cast<double>(sensor_64ths[axis]) / 64;
    }
    std::vector<oracle::CellNumbers> cells;
    std::vector<double> points;
    for (int i = 0; i < 40; ++i) {
      oracle::CellNumbers cell{in_room(random), in_room(random), in_room(random)};
      // Most are on walls; some of them beside it, now and then.
      if (i % 4 != 0) cell[static_cast<std::size_t>(i % 3)] = (one_of(random) % 2 == 0 ? 1 : -1) * wall(random);
      cells.push_back(cell);
      for (const std::int32_t number : cell) points.push_back(number + 0.25);
    }
    const bool has_origin = one_of(random) != 0;
    insert(grid, points, has_origin ? std::optional(origin) : std::nullopt, seconds(scan));
    // A sixteenth of the decay is half a second.
    plain.insert(cells, has_origin ? std::optional(sensor_64ths) : std::nullopt, decay ? 2 * scan : 0);
    std::size_t known = 0;
    for (std::int32_t z = -14; z < 14; ++z) {
      for (std::int32_t y = -14; y < 14; ++y) {
        for (std::int32_t x = -14; x < 14; ++x) {
          const VoxelNumber cell{x, y, z};
          ASSERT_EQ(grid.state(cell), plain.state(cell)) << "scan " << scan << ", cell " << x << ' ' << y << ' ' << z;
          known += grid.state(cell) != VoxelState::unknown ? 1 : 0;
        }
      }
    }
    ASSERT_EQ(known, plain.size()) << "a cell beyond the walls";
  }
  EXPECT_GT(grid.occupied_count(), 20U);
}

// Rays that change nothing more are left out, block by block: the cells are to be as if none were.
TEST(Voxels, ScansMakeOfCellsWhatEachRayWouldAlone) {
  expect_as_plain(UnknownCells::free, 28, {});
  expect_as_plain(UnknownCells::free, 29, seconds(8));
  expect_as_plain(UnknownCells::undecided, 30, {});
  expect_as_plain(UnknownCells::undecided, 31, seconds(8));
  expect_as_plain(UnknownCells::occupied, 32, seconds(8));
}

TEST(Voxels, WhereUnknownIsFreeACellIsOccupiedOrUnknown) {
  VoxelGrid grid = grid_of({.cell_m = 0.5});
  insert(grid, {3.2, 0.2, 0.2});
  EXPECT_EQ(insert(grid, {5.2, 0.2, 0.2}, Vec3(0.2, 0.2, 0.2)).crossed, 1U) << "only the cell that may change";
  EXPECT_EQ(grid.state({5, 0, 0}), VoxelState::unknown);
  for (int i = 0; i < 2; ++i) insert(grid, {5.2, 0.2, 0.2}, Vec3(0.2, 0.2, 0.2));
  EXPECT_EQ(grid.state({6, 0, 0}), VoxelState::unknown);
}

/// Rays farther than the table of a scan's blocks reaches.
TEST(Voxels, AScanOfFarPointsIsAsOneOfNearOnes) {
  const std::vector<double> far{15'000.5, 0.5, 0.5, 0.5, 15'000.5, 0.5, 0.5, 0.5, 15'000.5};
  for (const UnknownCells unknown : {UnknownCells::free, UnknownCells::undecided}) {
    VoxelGrid grid = grid_of({.cell_m = 1, .unknown = unknown});
    insert(grid, {700.5, 0.5, 0.5, 5.5, 0.5, 0.5});
    for (int i = 0; i < 3; ++i) insert(grid, far, Vec3(0.5, 0.5, 0.5));
    const VoxelState cleared = unknown == UnknownCells::free ? VoxelState::unknown : VoxelState::free;
    EXPECT_EQ(grid.state({700, 0, 0}), cleared);
    EXPECT_EQ(grid.state({5, 0, 0}), cleared);
    EXPECT_EQ(grid.state({0, 14'999, 0}), cleared);
    EXPECT_EQ(grid.state({0, 0, 15'000}), VoxelState::occupied);
    EXPECT_EQ(grid.state({1, 1, 1}), VoxelState::unknown);
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
