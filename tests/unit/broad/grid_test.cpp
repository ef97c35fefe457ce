#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "server/broad_phase/grid/grid.hpp"
#include "tests/oracle/box_pairs.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/broad/bvh_walks.hpp"

namespace collided::engine {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
using oracle::pairs_by_force;
using oracle::pairs_of;
using Numbers = std::vector<std::uint32_t>;

Aabb make_box(const Vec3& low, const Vec3& size) { return {low, low + size}; }

Numbers in_box(const Grid& grid, const Aabb& asked) {
  Numbers all;
  WalkCost cost;
  const auto collect = [&](std::uint32_t box) {
    all.push_back(box);
    return true;
  };
  grid.walk_box(asked, collect, cost);
  std::sort(all.begin(), all.end());
  return all;
}

Numbers in_box_by_force(const std::vector<Aabb>& boxes, const Aabb& asked) {
  Numbers all;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].empty() && overlaps(boxes[i], asked)) all.push_back(i);
  }
  return all;
}

Numbers along_ray(const Grid& grid, const Ray& ray, double limit) {
  Numbers all;
  WalkCost cost;
  const auto collect = [&](std::uint32_t box, double current) {
    all.push_back(box);
    return current;
  };
  grid.walk_ray(ray, limit, collect, cost);
  std::sort(all.begin(), all.end());
  return all;
}

/// Slabs in long double: parameters are right to far less than the grid's slack.
bool meets(const Ray& ray, const Aabb& box, double limit) {
  long double entry = 0;
  long double exit = limit;
  for (int axis = 0; axis < 3; ++axis) {
    const long double o = ray.origin[axis];
    const long double d = ray.direction[axis];
    if (ray.direction[axis] == 0) {
      if (o < box.low[axis] || o > box.high[axis]) return false;
      continue;
    }
    const long double at_low = (box.low[axis] - o) / d;
    const long double at_high = (box.high[axis] - o) / d;
    entry = std::max(entry, std::min(at_low, at_high));
    exit = std::min(exit, std::max(at_low, at_high));
  }
  return entry <= exit;
}

Numbers along_ray_by_force(const std::vector<Aabb>& boxes, const Ray& ray, double limit) {
  Numbers all;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].empty() && meets(ray, boxes[i], limit)) all.push_back(i);
  }
  return all;
}

Numbers near_point(const Grid& grid, const Vec3& point, double limit_m2) {
  Numbers found;
  WalkCost cost;
  const auto collect = [&](std::uint32_t box, double current) {
    found.push_back(box);
    return current;
  };
  grid.walk_near(point, limit_m2, collect, cost);
  std::sort(found.begin(), found.end());
  return found;
}

double distance_m2(const Aabb& box, const Vec3& point) {
  return (box.low - point).cwiseMax(point - box.high).cwiseMax(0.0).squaredNorm();
}

Numbers near_by_force(const std::vector<Aabb>& boxes, const Vec3& point, double limit_m2) {
  Numbers all;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].empty() && distance_m2(boxes[i], point) <= limit_m2) all.push_back(i);
  }
  return all;
}

bool each_once(const Numbers& sorted) { return std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end(); }

/// Every question against its brute-force twin.
void expect_right(const Grid& grid, const std::vector<Aabb>& boxes, double extent, std::mt19937_64& random) {
  EXPECT_EQ(pairs_of(grid), pairs_by_force(boxes));
  for (int i = 0; i < 100; ++i) {
    const Vec3 from = extent * in_cube(random);
    const Aabb asked = make_box(from, extent * 0.2 * in_cube(random).cwiseAbs());
    EXPECT_EQ(in_box(grid, asked), in_box_by_force(boxes, asked));

    Ray ray{2 * from, in_cube(random)};
    const std::uint64_t zero = random() % 6;
    if (zero < 3) ray.direction[static_cast<int>(zero)] = 0;
    if (zero == 0) ray.direction[1] = -0.0;
    const double limit = i % 2 == 0 ? kEndless : 2 * extent;
    const Numbers met = along_ray(grid, ray, limit);
    const Numbers expected = along_ray_by_force(boxes, ray, limit);
    EXPECT_TRUE(std::includes(met.begin(), met.end(), expected.begin(), expected.end()));
    EXPECT_LE(met.size(), expected.size() + 2);
    EXPECT_TRUE(each_once(met));

    const double limit_m2 = i % 10 == 0 ? kEndless : 0.01 * extent * extent;
    const Numbers close = near_point(grid, from, limit_m2);
    const Numbers expected_close = near_by_force(boxes, from, limit_m2);
    EXPECT_TRUE(std::includes(close.begin(), close.end(), expected_close.begin(), expected_close.end()));
    EXPECT_LE(close.size(), expected_close.size() + 2);
    EXPECT_TRUE(each_once(close));
  }
}

void expect_right(const std::vector<Aabb>& boxes, double extent, std::mt19937_64& random) {
  Grid grid;
  grid.rebuild(boxes);
  expect_right(grid, boxes, extent, random);
}

// A53: pairs as brute force has them, each once. A giant over all cells: AGiantAmongDustCostsAlmostNothing.
TEST(BroadGrid, EqualsBruteForceOnBoxesOfOneSize) {
  std::mt19937_64 random = oracle::seeded(20240607);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 2000; ++i) boxes.push_back(make_box(in_cube(random), Vec3::Constant(0.05)));
  expect_right(boxes, 1, random);
}

// Rows of many cells: a walk goes through them block by block.
TEST(BroadGrid, ALongRayIsToldEachOfManySmallBoxesOnce) {
  std::mt19937_64 random = oracle::seeded(236);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 20'000; ++i)
    boxes.push_back(make_box(in_cube(random).cwiseProduct(Vec3(4, 1, 0.1)), Vec3::Constant(0.02)));
  Grid grid;
  grid.rebuild(boxes);
  std::size_t told = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 from = in_cube(random).cwiseProduct(Vec3(5, 1, 0.1));
    const Vec3 to = in_cube(random).cwiseProduct(Vec3(5, 1, 0.1));
    const Ray ray{.origin = from, .direction = to - from};
    const double limit = i % 2 == 0 ? kEndless : 1;
    const Numbers met = along_ray(grid, ray, limit);
    const Numbers expected = along_ray_by_force(boxes, ray, limit);
    EXPECT_TRUE(std::includes(met.begin(), met.end(), expected.begin(), expected.end()));
    EXPECT_TRUE(each_once(met));
    told += met.size();
  }
  EXPECT_GT(told, 1000U);
}

TEST(BroadGrid, EqualsBruteForceOnSizesOverTenDecades) {
  std::mt19937_64 random = oracle::seeded(20240607);
  std::uniform_real_distribution<double> decade(-9, 1);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 2000; ++i) {
    boxes.push_back(make_box(in_cube(random), std::pow(10.0, decade(random)) * in_cube(random).cwiseAbs()));
  }
  expect_right(boxes, 1, random);
}

// Cell borders, also negative ones and both zeros: an object there is found from all eight cells, once.
TEST(BroadGrid, ObjectsOnCellBordersAreFoundOnce) {
  std::mt19937_64 random = oracle::seeded(20240620);
  std::vector<Aabb> boxes;
  for (int x = -3; x <= 3; ++x) {
    for (int y = -3; y <= 3; ++y) {
      for (int z = -3; z <= 3; ++z) {
        const Vec3 corner(x == 0 ? -0.0 : x, y, z == 0 ? -0x1p-1074 : z);
        boxes.push_back(make_box(corner, Vec3::Ones()));
        boxes.push_back(make_box(corner, Vec3::Zero()));
        boxes.push_back(make_box(Vec3(std::nextafter(x, -9), y, std::nextafter(z, 9)), Vec3(1, 0.5, 1)));
      }
    }
  }
  expect_right(boxes, 4, random);
}

// A55
TEST(BroadGrid, CoordinatesFarOutLoseNothing) {
  std::mt19937_64 random = oracle::seeded(20240621);
  for (const double far : {1e6, 1e9, 1e12, 1e15, 1e100, 1e300}) {
    SCOPED_TRACE(far);
    const double extent = std::max(1.0, 1e-13 * far);
    std::vector<Aabb> boxes;
    for (int i = 0; i < 500; ++i) {
      const Vec3 low = Vec3(far, -far, far) + extent * in_cube(random);
      boxes.push_back(make_box(low, 0.1 * extent * in_cube(random).cwiseAbs()));
    }
    Grid grid;
    grid.rebuild(boxes);
    EXPECT_EQ(pairs_of(grid), pairs_by_force(boxes));
    for (int i = 0; i < 50; ++i) {
      const Aabb& aim = boxes[random() % boxes.size()];
      const Ray ray{Vec3(far, -far, far) + 3 * extent * in_cube(random), Vec3(extent, 2 * extent, -extent)};
      const Numbers met = along_ray(grid, ray, kEndless);
      const Numbers expected = along_ray_by_force(boxes, ray, kEndless);
      EXPECT_TRUE(std::includes(met.begin(), met.end(), expected.begin(), expected.end()));
      EXPECT_EQ(in_box(grid, aim), in_box_by_force(boxes, aim));
      const Numbers close = near_point(grid, aim.low, extent * extent);
      const Numbers expected_close = near_by_force(boxes, aim.low, extent * extent);
      EXPECT_TRUE(std::includes(close.begin(), close.end(), expected_close.begin(), expected_close.end()));
    }
  }
}

TEST(BroadGrid, EveryScaleOfDoublesInOneSceneLosesNothing) {
  std::mt19937_64 random = oracle::seeded(20240622);
  std::uniform_real_distribution<double> decade(-307, 307);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 low = std::pow(10.0, decade(random)) * in_cube(random);
    boxes.push_back(make_box(low, std::pow(10.0, decade(random)) * in_cube(random).cwiseAbs()));
  }
  Grid grid;
  grid.rebuild(boxes);
  EXPECT_EQ(pairs_of(grid), pairs_by_force(boxes));
  for (int i = 0; i < 100; ++i) {
    const Aabb& asked = boxes[i];
    EXPECT_EQ(in_box(grid, asked), in_box_by_force(boxes, asked));
    const Ray ray{boxes[i].low, boxes[i + 1].low};
    const Numbers met = along_ray(grid, ray, kEndless);
    const Numbers expected = along_ray_by_force(boxes, ray, kEndless);
    EXPECT_TRUE(std::includes(met.begin(), met.end(), expected.begin(), expected.end()));
  }
}

TEST(BroadGrid, InfiniteAndEmptyBoxes) {
  std::mt19937_64 random = oracle::seeded(20240623);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 300; ++i) boxes.push_back(make_box(in_cube(random), Vec3::Constant(0.1)));
  boxes.push_back({Vec3::Constant(-kEndless), Vec3::Constant(kEndless)});
  boxes.push_back({Vec3(-kEndless, -kEndless, -kEndless), Vec3(kEndless, kEndless, 0)});
  boxes.push_back({Vec3::Constant(-1.7e308), Vec3::Constant(1.7e308)});
  boxes.push_back(Aabb{});
  boxes.push_back({Vec3::Constant(std::nan("")), Vec3::Ones()});
  expect_right(boxes, 1, random);
  Grid grid;
  grid.rebuild(boxes);
  EXPECT_EQ(grid.size(), 303u);
}

TEST(BroadGrid, EmptySceneAndFewBoxes) {
  std::mt19937_64 random = oracle::seeded(20240624);
  Grid grid;
  EXPECT_TRUE(pairs_of(grid).empty());
  EXPECT_TRUE(in_box(grid, {Vec3::Constant(-1), Vec3::Constant(1)}).empty());
  EXPECT_TRUE(along_ray(grid, {Vec3::Zero(), Vec3::UnitX()}, kEndless).empty());
  EXPECT_TRUE(near_point(grid, Vec3::Zero(), kEndless).empty());
  std::vector<Aabb> boxes;
  for (int count = 1; count < 40; ++count) {
    boxes.push_back(make_box(in_cube(random), in_cube(random).cwiseAbs()));
    expect_right(boxes, 1, random);
  }
}

TEST(BroadGrid, RebuildForgetsTheOldBoxes) {
  std::mt19937_64 random = oracle::seeded(20240625);
  Grid grid;
  for (const int count : {2000, 10, 0, 500, 3000}) {
    std::vector<Aabb> boxes;
    for (int i = 0; i < count; ++i) boxes.push_back(make_box(in_cube(random), 0.1 * in_cube(random).cwiseAbs()));
    grid.rebuild(boxes);
    EXPECT_EQ(pairs_of(grid), pairs_by_force(boxes));
    EXPECT_EQ(grid.size(), boxes.size());
  }
}

std::uint64_t count_pairs(const Grid& grid, WalkCost& cost) {
  std::uint64_t count = 0;
  const auto add = [&](std::uint32_t, std::uint32_t) {
    ++count;
    return true;
  };
  grid.pairs(add, cost);
  return count;
}

// What an update leaves out of its own index must still be hidden in, or found by, the one that it shares.
TEST(BroadGrid, UpdatedBoxesAreFoundAsAfterARebuild) {
  std::mt19937_64 random = oracle::seeded(20261124);
  for (const std::size_t count : {std::size_t{40}, std::size_t{400}, std::size_t{1500}}) {
    std::vector<Aabb> boxes;
    const auto any_box = [&] { return make_box(in_cube(random), 0.15 * in_cube(random).cwiseAbs()); };
    while (boxes.size() < count) boxes.push_back(any_box());
    Grid grids[2];
    grids[0].rebuild(boxes);
    for (int step = 0; step < 25; ++step) {
      std::vector<std::uint32_t> changed;
      for (std::size_t i = 0; i < 1 + count / 100; ++i) {
        const auto number = static_cast<std::uint32_t>(random() % boxes.size());
        changed.push_back(number);
        // Some leave, some come back, and some are of a size that has no level so far.
        boxes[number] = random() % 4 == 0 ? Aabb{} : any_box();
        if (random() % 8 == 0) boxes[number] = make_box(in_cube(random), Vec3::Constant(1.5));
      }
      changed.push_back(static_cast<std::uint32_t>(boxes.size()));
      boxes.push_back(any_box());
      Grid& grid = grids[(step + 1) % 2];
      grid.update(grids[step % 2], boxes, changed);
      const auto held = std::count_if(boxes.begin(), boxes.end(), [](const Aabb& box) { return !box.empty(); });
      EXPECT_EQ(grid.size(), static_cast<std::size_t>(held)) << count << " boxes, step " << step;
      if (step % 4 == 0) expect_right(grid, boxes, 1, random);
    }
  }
}

// A few that change in each of many updates are in indexes over indexes: those that change again are found where they are
// now, and only there.
TEST(BroadGrid, ATrickleOfChangesIsFoundAsAfterARebuild) {
  std::mt19937_64 random = oracle::seeded(20261127);
  constexpr std::size_t kCount = 4'000;
  const auto any_box = [&] { return make_box(8 * in_cube(random), 0.5 * in_cube(random).cwiseAbs()); };
  std::vector<Aabb> boxes;
  while (boxes.size() < kCount) boxes.push_back(any_box());
  Grid grids[3];  // as many as there are states under way
  grids[0].rebuild(boxes);
  std::vector<std::uint32_t> changed_before;
  for (int step = 0; step < 400; ++step) {
    std::vector<std::uint32_t> changed;
    for (std::size_t i = 0; i < random() % 4; ++i) {
      const bool is_again = !changed_before.empty() && random() % 2 == 0;
      changed.push_back(is_again ? changed_before[random() % changed_before.size()]
                                 : static_cast<std::uint32_t>(random() % boxes.size()));
      boxes[changed.back()] = random() % 5 == 0 ? Aabb{} : any_box();
    }
    if (step % 3 == 0) {
      changed.push_back(static_cast<std::uint32_t>(boxes.size()));
      boxes.push_back(any_box());
    }
    changed_before.insert(changed_before.end(), changed.begin(), changed.end());
    Grid& grid = grids[(step + 1) % 3];
    grid.update(grids[step % 3], boxes, changed);
    const auto held = std::count_if(boxes.begin(), boxes.end(), [](const Aabb& box) { return !box.empty(); });
    ASSERT_EQ(grid.size(), static_cast<std::size_t>(held)) << "step " << step;
    if (step % 20 == 0) expect_right(grid, boxes, 8, random);
  }
}

TEST(BroadGrid, AnUpdateOfFewAmongManyLooksAtFew) {
  std::mt19937_64 random = oracle::seeded(20261125);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 20'000; ++i) boxes.push_back(make_box(50 * in_cube(random), Vec3::Constant(0.5)));
  Grid before;
  before.rebuild(boxes);
  const std::vector<std::uint32_t> changed{7, 77, 777};
  for (const std::uint32_t number : changed) boxes[number] = make_box(50 * in_cube(random), Vec3::Constant(0.5));
  Grid after;
  after.update(before, boxes, changed);
  EXPECT_LT(after.bytes(), before.bytes() + 64 * boxes.size() / 8) << "the rest is shared, not copied";
  expect_right(after, boxes, 50, random);
}

TEST(BroadGrid, AWalkThatEndsInTheSharedPartEndsAtAll) {
  std::mt19937_64 random = oracle::seeded(20261126);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 2000; ++i) boxes.push_back(make_box(in_cube(random), Vec3::Constant(0.5)));
  Grid before;
  before.rebuild(boxes);
  Grid grid;
  grid.update(before, boxes, std::vector<std::uint32_t>{1, 2, 3});
  WalkCost cost;
  int told = 0;
  const auto tell = [&](std::uint32_t) { return ++told < 2; };
  grid.walk_box({Vec3::Constant(-2), Vec3::Constant(2)}, tell, cost);
  EXPECT_EQ(told, 2);
  told = 0;
  const auto tell_pair = [&](std::uint32_t, std::uint32_t) { return ++told < 2; };
  grid.pairs(tell_pair, cost);
  EXPECT_EQ(told, 2);
  told = 0;
  const auto stop = [&](std::uint32_t, double) { return ++told, -1.0; };
  grid.walk_ray({Vec3(-2, 0, 0), Vec3(1, 0, 0)}, kEndless, stop, cost);
  EXPECT_EQ(told, 1);
  told = 0;
  grid.walk_near(Vec3::Zero(), kEndless, stop, cost);
  EXPECT_EQ(told, 1);
}

TEST(BroadGrid, BoxesInOnePointAreEnumeratedWithoutMemory) {
  const std::vector<Aabb> boxes(20'000, make_box(Vec3(1, 2, 3), Vec3::Constant(0.5)));
  Grid grid;
  grid.rebuild(boxes);
  WalkCost cost;
  EXPECT_EQ(count_pairs(grid, cost), 20'000ull * 19'999 / 2);
  EXPECT_LT(grid.bytes(), boxes.size() * 200);
  Grid for_pairs(Grid::Use::pairs);
  for_pairs.rebuild(boxes);
  EXPECT_LT(for_pairs.bytes(), boxes.size() * 120);
}

// One giant over a million grains adds one comparison a grain, not a cell a grain's size across itself.
TEST(BroadGrid, AGiantAmongDustCostsAlmostNothing) {
  std::mt19937_64 random(11);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 100'000; ++i) boxes.push_back(make_box(1000 * in_cube(random), Vec3::Constant(0.5)));
  Grid grid;
  WalkCost without;
  grid.rebuild(boxes);
  const std::uint64_t dust_pairs = count_pairs(grid, without);
  boxes.push_back(make_box(Vec3::Constant(-1e6), Vec3::Constant(2e6)));
  WalkCost with;
  grid.rebuild(boxes);
  EXPECT_EQ(count_pairs(grid, with), dust_pairs + 100'000);
  EXPECT_LT(with.nodes, without.nodes + 1000);
}

TEST(BroadGrid, FalseAndNegativeLimitsEndTheWalk) {
  std::mt19937_64 random(12);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 5000; ++i) boxes.push_back(make_box(in_cube(random), Vec3::Constant(0.2)));
  Grid grid;
  grid.rebuild(boxes);
  WalkCost cost;
  grid.walk_box(
      {Vec3::Constant(-1), Vec3::Constant(1)}, [](std::uint32_t) { return false; }, cost);
  EXPECT_EQ(cost.candidates, 1u);
  cost = {};
  const auto stop = [](std::uint32_t, double) { return -1.0; };
  grid.walk_ray({Vec3(-2, 0, 0), Vec3(1, 0, 0)}, kEndless, stop, cost);
  EXPECT_EQ(cost.candidates, 1u);
  cost = {};
  grid.walk_near(Vec3::Zero(), kEndless, stop, cost);
  EXPECT_EQ(cost.candidates, 1u);
}

// Rays look at cells along their way, not at every box.
TEST(BroadGrid, RaysAndPointsLookAtFewBoxes) {
  std::mt19937_64 random(13);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 100'000; ++i) boxes.push_back(make_box(in_cube(random), Vec3::Constant(0.02)));
  Grid grid;
  grid.rebuild(boxes);
  WalkCost ray_cost;
  WalkCost near_cost;
  for (int i = 0; i < 20; ++i) {
    grid.walk_ray(
        {in_cube(random), in_cube(random)}, kEndless, [](std::uint32_t, double) { return 0.0; }, ray_cost);
    grid.walk_near(
        in_cube(random), kEndless, [](std::uint32_t, double) { return 1e-4; }, near_cost);
  }
  EXPECT_LT(ray_cost.nodes, 20u * 3000);
  EXPECT_LT(near_cost.nodes, 20u * 100);
}

}  // namespace
}  // namespace collided::engine
