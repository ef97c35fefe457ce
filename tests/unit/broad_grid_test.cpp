#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "server/broad_phase/grid.hpp"
#include "tests/scenes/seed.hpp"

namespace collided {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
using Numbers = std::vector<std::uint32_t>;

Aabb make_box(const Vec3& low, const Vec3& size) { return {low, low + size}; }

Vec3 in_cube(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return {x, y, coordinate(random)};
}

Pairs pairs_of(const Grid& grid) {
  Pairs all;
  WalkCost cost;
  const auto collect = [](void* context, std::uint32_t first, std::uint32_t second) {
    static_cast<Pairs*>(context)->emplace_back(first, second);
  };
  grid.pairs(collect, &all, cost);
  std::sort(all.begin(), all.end());
  return all;
}

Pairs pairs_by_force(const std::vector<Aabb>& boxes) {
  Pairs all;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    for (std::uint32_t j = i + 1; j < boxes.size(); ++j) {
      if (!boxes[i].empty() && !boxes[j].empty() && overlaps(boxes[i], boxes[j])) all.emplace_back(i, j);
    }
  }
  return all;
}

Numbers in_box(const Grid& grid, const Aabb& asked) {
  Numbers all;
  WalkCost cost;
  const auto collect = [](void* context, std::uint32_t box) {
    static_cast<Numbers*>(context)->push_back(box);
    return true;
  };
  grid.walk_box(asked, collect, &all, cost);
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
  const auto collect = [](void* context, std::uint32_t box, double current) {
    static_cast<Numbers*>(context)->push_back(box);
    return current;
  };
  grid.walk_ray(ray, limit, collect, &all, cost);
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

struct NearSearch {
  Numbers found;
  double limit_m2 = 0;
};

Numbers near_point(const Grid& grid, const Vec3& point, double limit_m2) {
  NearSearch search;
  WalkCost cost;
  const auto collect = [](void* context, std::uint32_t box, double current) {
    static_cast<NearSearch*>(context)->found.push_back(box);
    return current;
  };
  grid.walk_near(point, limit_m2, collect, &search, cost);
  std::sort(search.found.begin(), search.found.end());
  return search.found;
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
void expect_right(const std::vector<Aabb>& boxes, double extent, std::mt19937_64& random) {
  Grid grid;
  grid.rebuild(boxes);
  EXPECT_EQ(pairs_of(grid), pairs_by_force(boxes));
  for (int i = 0; i < 100; ++i) {
    const Vec3 from = extent * in_cube(random);
    const Aabb asked = make_box(from, extent * 0.2 * in_cube(random).cwiseAbs());
    EXPECT_EQ(in_box(grid, asked), in_box_by_force(boxes, asked));

    Ray ray{2 * from, in_cube(random)};
    const std::uint64_t zero = random() % 6;
    if (zero < 3) ray.direction[static_cast<int>(zero)] = 0;
    if (zero == 0) ray.direction[1] = -0.0;
    const double limit = i % 2 == 0 ? kInfinity : 2 * extent;
    const Numbers met = along_ray(grid, ray, limit);
    const Numbers expected = along_ray_by_force(boxes, ray, limit);
    EXPECT_TRUE(std::includes(met.begin(), met.end(), expected.begin(), expected.end()));
    EXPECT_LE(met.size(), expected.size() + 2);
    EXPECT_TRUE(each_once(met));

    const double limit_m2 = i % 10 == 0 ? kInfinity : 0.01 * extent * extent;
    const Numbers close = near_point(grid, from, limit_m2);
    const Numbers expected_close = near_by_force(boxes, from, limit_m2);
    EXPECT_TRUE(std::includes(close.begin(), close.end(), expected_close.begin(), expected_close.end()));
    EXPECT_LE(close.size(), expected_close.size() + 2);
    EXPECT_TRUE(each_once(close));
  }
}

TEST(BroadGrid, EqualsBruteForceOnBoxesOfOneSize) {
  std::mt19937_64 random(scenes::seed());
  std::vector<Aabb> boxes;
  for (int i = 0; i < 2000; ++i) boxes.push_back(make_box(in_cube(random), Vec3::Constant(0.05)));
  expect_right(boxes, 1, random);
}

TEST(BroadGrid, EqualsBruteForceOnSizesOverTenDecades) {
  std::mt19937_64 random(scenes::seed());
  std::uniform_real_distribution<double> decade(-9, 1);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 2000; ++i) {
    boxes.push_back(make_box(in_cube(random), std::pow(10.0, decade(random)) * in_cube(random).cwiseAbs()));
  }
  expect_right(boxes, 1, random);
}

}  // namespace
}  // namespace collided
