// What the walks and the build leave alone: an index that looked at everything would answer as well, but not be one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

Bvh tree_of(const TriangleMesh& mesh) { return Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}}); }

/// Squares of side 2 across z, one above the other, in no order.
TriangleMesh layers(std::uint32_t count, std::mt19937_64& random) {
  std::vector<std::uint32_t> order(count);
  for (std::uint32_t i = 0; i < count; ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), random);
  TriangleMesh mesh;
  for (const std::uint32_t i : order) {
    const double z = static_cast<double>(i) / count;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

/// Takes what the ray meets and wants nothing beyond it.
struct First {
  const Ray& ray;
  double distance_m = kNoLimit;

  double operator()(std::uint32_t, const Triangle& corners, double limit) {
    RayHit hit;
    if (!cast_ray(ray, corners, hit).yes()) return limit;
    distance_m = std::min(distance_m, hit.distance_m);
    return std::min(limit, hit.distance_m * (1 + 0x1p-40));
  }
};

/// Down onto the layers from just above, close to each other.
std::vector<Ray> rain() {
  std::vector<Ray> rays;
  for (int i = 0; i < 32; ++i) rays.push_back({{0.3 + i * 1e-4, 0.2, 1.125}, {0, 0, -1}});
  return rays;
}

TEST(BroadEffort, ABoxLooksAtLittleHoweverTheTrianglesAreOrdered) {
  std::mt19937_64 random = oracle::seeded(204);
  TriangleMesh mesh = scenes::terrain(64, 2, 1);
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  const Bvh tree = tree_of(mesh);
  WalkCost cost;
  std::set<std::uint32_t> found;
  const auto take = [&](std::uint32_t number) {
    found.insert(number);
    return true;
  };
  tree.walk_box({.low = {0.1, 0.1, -9}, .high = {0.11, 0.11, 9}}, take, cost);
  EXPECT_GE(found.size(), 2U);
  EXPECT_LE(cost.nodes, 40U) << "of " << tree.report().nodes + tree.report().leaves;
  EXPECT_LE(cost.candidates, 40U);
}

TEST(BroadEffort, TheNearestOfManyLayersIsFoundWithoutAVisitToTheOthers) {
  std::mt19937_64 random = oracle::seeded(217);
  const TriangleMesh mesh = layers(4096, random);
  const Bvh tree = tree_of(mesh);
  const std::vector<Ray> rays = rain();
  std::vector<WalkCost> costs(rays.size());
  std::vector<First> first;
  for (const Ray& ray : rays) first.push_back({ray});
  std::vector<Bvh::RayTask> tasks;
  for (std::size_t i = 0; i < rays.size(); ++i) tasks.push_back({&rays[i], kNoLimit, first[i], &costs[i]});
  tree.walk_rays(tasks, mesh, Bvh::RayGoal::nearest);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    First alone{rays[i]};
    WalkCost cost;
    tree.walk_ray_nearest(rays[i], kNoLimit, mesh, alone, cost);
    EXPECT_NEAR(alone.distance_m, 0.125 + 1.0 / 4096, 1e-12);
    EXPECT_EQ(first[i].distance_m, alone.distance_m);
    EXPECT_LE(cost.nodes, 60U);
    EXPECT_LE(costs[i].nodes, 60U);
    EXPECT_LE(cost.candidates, 4U);
    EXPECT_LE(costs[i].candidates, 4U);
  }
}

// Needles that the ray passes by: their boxes are in its way, and only the wall in front says that they need no look.
TEST(BroadEffort, ASurelyMetWallHidesWhatIsBehindIt) {
  std::mt19937_64 random = oracle::seeded(2170);
  TriangleMesh mesh = scenes::slanted(8000, 0.5, random());
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {{-2, -2, 2}, {2, -2, 2}, {0, 3, 2}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  const Bvh tree = tree_of(mesh);
  std::vector<Ray> rays = rain();
  for (Ray& ray : rays) ray.origin.z() = 2.125;
  std::vector<WalkCost> costs(rays.size());
  std::vector<First> met;
  for (const Ray& ray : rays) met.push_back({ray});
  std::vector<Bvh::RayTask> tasks;
  for (std::size_t i = 0; i < rays.size(); ++i) tasks.push_back({&rays[i], kNoLimit, met[i], &costs[i]});
  tree.walk_rays(tasks, mesh, Bvh::RayGoal::nearest);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    First alone{rays[i]};
    WalkCost cost;
    tree.walk_ray_nearest(rays[i], kNoLimit, mesh, alone, cost);
    EXPECT_NEAR(alone.distance_m, 0.125, 1e-12);
    EXPECT_NEAR(met[i].distance_m, 0.125, 1e-12);
    EXPECT_LE(cost.nodes, 12U);
    EXPECT_LE(costs[i].nodes, 12U);
  }
}

TEST(BroadEffort, ARayOfABatchThatHasMetSomethingGoesNoFarther) {
  std::mt19937_64 random = oracle::seeded(223);
  const TriangleMesh mesh = layers(4096, random);
  const Bvh tree = tree_of(mesh);
  const std::vector<Ray> rays = rain();
  std::vector<WalkCost> costs(rays.size());
  std::vector<First> first;
  for (const Ray& ray : rays) first.push_back({ray});
  std::vector<Bvh::RayTask> tasks;
  for (std::size_t i = 0; i < rays.size(); ++i) tasks.push_back({&rays[i], kNoLimit, first[i], &costs[i]});
  tree.walk_rays(tasks, mesh, Bvh::RayGoal::any);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_NE(tasks[i].met, Bvh::kNoTriangle);
    EXPECT_LE(costs[i].nodes, 60U);
  }
}

TEST(BroadEffort, OfALeafOnlyWhatMayBeNearestIsTold) {
  std::mt19937_64 random = oracle::seeded(221);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  struct Nearest {
    const Vec3& point;
    const TriangleMesh& mesh;
    double best_m = kNoLimit;
    double operator()(std::uint32_t number, double limit_m2) {
      best_m = std::min(best_m, closest(point, mesh.triangle(number)).distance_m);
      return std::min(limit_m2, best_m * best_m * (1 + 0x1p-40));
    }
  };
  // Long and askew, so that their boxes say little.
  const TriangleMesh mesh = scenes::slanted(2000, 0.5, random());
  const Bvh tree = tree_of(mesh);
  WalkCost cost;
  constexpr int kPoints = 100;
  for (int i = 0; i < kPoints; ++i) {
    const Vec3 point(coordinate(random), coordinate(random), coordinate(random));
    Nearest nearest{point, mesh};
    tree.walk_near(point, kNoLimit, 0, nearest, cost);
    double truth_m = kNoLimit;
    for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k)
      truth_m = std::min(truth_m, closest(point, mesh.triangle(k)).distance_m);
    EXPECT_EQ(nearest.best_m, truth_m);
  }
  EXPECT_LE(cost.candidates, 5U * kPoints);
}

TEST(BroadEffort, PairsOfALargeAndASmallMeshAreFewWhicheverIsAsked) {
  const TriangleMesh large = scenes::icosphere(4, 1);
  const TriangleMesh small = scenes::icosphere(4, 0.2);
  const Bvh large_tree = tree_of(large);
  const Bvh small_tree = tree_of(small);
  const auto take = [](std::uint32_t, std::uint32_t) { return true; };
  WalkCost cost[2];
  large_tree.walk_pairs(small_tree, Mat3::Identity(), {1, 0, 0}, 0, take, cost[0]);
  small_tree.walk_pairs(large_tree, Mat3::Identity(), {-1, 0, 0}, 0, take, cost[1]);
  for (const WalkCost& of : cost) {
    EXPECT_GE(of.candidates, 20U);
    EXPECT_LE(of.candidates, 2000U);
  }
}

// Corners that are no floats in the tree's frame are fetched from the mesh, whatever places of a leaf they have.
TEST(BroadEffort, ABatchOfRaysHearsEveryTriangleOfAMeshOfDoubles) {
  std::mt19937_64 random = oracle::seeded(226);
  const TriangleMesh mesh = scenes::scattered(600, 0.4, random());
  const Bvh tree = tree_of(mesh);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::vector<Ray> rays;
  for (int i = 0; i < 100; ++i) {
    const Vec3 from(coordinate(random), coordinate(random), coordinate(random));
    rays.push_back({2 * from, Vec3(coordinate(random), coordinate(random), coordinate(random)) - 2 * from});
  }
  struct Met {
    const Ray& ray;
    std::set<std::uint32_t> numbers{};
    double operator()(std::uint32_t number, const Triangle& corners, double limit) {
      RayHit hit;
      if (cast_ray(ray, corners, hit).yes()) numbers.insert(number);
      return limit;
    }
  };
  std::vector<Met> met;
  for (const Ray& ray : rays) met.push_back({ray});
  WalkCost cost;
  std::vector<Bvh::RayTask> tasks;
  for (std::size_t i = 0; i < rays.size(); ++i) tasks.push_back({&rays[i], kNoLimit, met[i], &cost});
  tree.walk_rays(tasks, mesh, Bvh::RayGoal::every);
  std::size_t hits = 0;
  for (const Met& one : met) {
    std::set<std::uint32_t> truth;
    RayHit hit;
    for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
      if (cast_ray(one.ray, mesh.triangle(k), hit).yes()) truth.insert(k);
    }
    EXPECT_EQ(one.numbers, truth);
    hits += truth.size();
  }
  EXPECT_GT(hits, 200U);
}

std::size_t threads_now() {
  const std::filesystem::directory_iterator all("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

// Who has one core to give gets no other thread, hears how far the build is, and is asked whether to go on.
TEST(BroadEffort, ABuildOnOneThreadStaysOnItAndCanBeWatchedAndEnded) {
  const TriangleMesh mesh = scenes::terrain(128, 2, 1);
  const std::size_t threads_before = threads_now();
  std::size_t most_threads = 0;
  std::size_t told = 0;
  double last = 0;
  const auto progress = [&](double done) {
    most_threads = std::max(most_threads, threads_now());
    EXPECT_GE(done, last);
    last = done;
    ++told;
  };
  EXPECT_GT(Bvh::build(mesh, {.threads = 1, .progress = progress, .cancelled = {}}).report().leaves, 0U);
  EXPECT_EQ(most_threads, threads_before);
  EXPECT_GE(told, 30U);
  int asked = 0;
  const Bvh ended = Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = [&] { return ++asked == 20; }});
  EXPECT_EQ(asked, 20) << "not again once it was told to end";
  EXPECT_EQ(ended.report().leaves, 0U);
}

}  // namespace
}  // namespace collided::engine
