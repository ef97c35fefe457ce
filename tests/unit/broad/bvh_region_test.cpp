// Walks of the hierarchy by a box and by a point.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/unit/broad/bvh_walks.hpp"

namespace collided::engine {
namespace {

TEST(BroadBvhBox, OffersTheTrianglesWhoseBoundsOverlapAndHardlyMore) {
  std::mt19937_64 random = oracle::seeded(20240615);
  for (const double offset : {0.0, 1e4, 1e9}) {
    TriangleMesh mesh = scenes::scattered(3000, 0.05, random());
    for (Vec3& vertex : mesh.vertices) vertex += Vec3(offset, 0, -offset);
    const Bvh tree = Bvh::build(mesh);
    std::size_t expected_count = 0;
    std::size_t found_count = 0;
    for (int i = 0; i < 300; ++i) {
      Aabb asked;
      asked.low = Vec3(offset, 0, -offset) + in_cube(random);
      asked.high = asked.low + 0.5 * in_cube(random).cwiseAbs();
      // Half of them touch a triangle's bounds in one number.
      if (i % 2 == 0) asked.high[0] = bounds_of(mesh.triangle(static_cast<std::uint32_t>(random() % 3000))).low[0];
      if (i % 7 == 0) asked.low[1] = -kInfinity;
      if (asked.empty()) continue;
      const Numbers expected = in_box_by_force(mesh, asked);
      const Numbers found = in_box(tree, asked);
      EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end()));
      expected_count += expected.size();
      found_count += found.size();
    }
    EXPECT_GT(expected_count, 0u);
    EXPECT_LE(found_count, expected_count + 20);
  }
}

TEST(BroadBvhBox, EmptyAsksNothingAndInfiniteAsksAll) {
  const Bvh tree = Bvh::build(scenes::icosphere(2, 1));
  EXPECT_TRUE(in_box(tree, Aabb{}).empty());
  EXPECT_EQ(in_box(tree, {Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity)}).size(), 320u);
}

TEST(BroadBvhBox, FalseEndsTheWalk) {
  const Bvh tree = Bvh::build(scenes::icosphere(2, 1));
  WalkCost cost;
  tree.walk_box(
      tree.bounds(), [](std::uint32_t) { return false; }, cost);
  EXPECT_EQ(cost.candidates, 1u);
}

TEST(BroadBvhNear, OffersWhatLiesWithinTheLimitAndHardlyMore) {
  std::mt19937_64 random = oracle::seeded(20240616);
  for (const int exponent : {-500, -40, 0, 40, 500}) {
    const double scale = std::ldexp(1.0, exponent);
    TriangleMesh mesh = scenes::scattered(3000, 0.05, random());
    for (Vec3& vertex : mesh.vertices) vertex *= scale;
    const Bvh tree = Bvh::build(mesh);
    std::size_t expected_count = 0;
    std::size_t found_count = 0;
    std::size_t box_count = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3 point = 1.5 * scale * in_cube(random);
      const double limit_m = 0.2 * scale * std::abs(in_cube(random)[0]);
      const Numbers expected = near_by_force(mesh, point, limit_m);
      const Numbers found = near_point(tree, point, limit_m * limit_m);
      EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end()));
      expected_count += expected.size();
      found_count += found.size();
      box_count += boxes_near(mesh, point, limit_m);
    }
    EXPECT_GT(expected_count, 0u);
    EXPECT_LE(found_count, box_count + 20);
  }
}

TEST(BroadBvhNear, FarAndExtremePointsLoseNothing) {
  std::mt19937_64 random = oracle::seeded(20240617);
  const TriangleMesh mesh = scenes::icosphere(2, 1);
  const Bvh tree = Bvh::build(mesh);
  for (const double far : {0.0, 3.0, 1e3, 1e8, 1e15, 1e100, 1e150}) {
    const Vec3 point = far * in_cube(random);
    for (const double factor : {0.999999, 1.0, 1.000001, 2.0}) {
      const double limit_m = factor * point.stableNorm();
      const Numbers expected = near_by_force(mesh, point, limit_m);
      const Numbers found = near_point(tree, point, limit_m * limit_m);
      EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end())) << far;
    }
  }
  EXPECT_EQ(near_point(tree, Vec3::Constant(1.7e308), kInfinity).size(), 320u);
}

TEST(BroadBvhNear, SlackCoversDisplacedVertices) {
  std::mt19937_64 random = oracle::seeded(20240619);
  const TriangleMesh mesh = scenes::icosphere(2, 1);
  const Bvh tree = Bvh::build(mesh);
  for (const double slack : {1e-12, 1e-3, 0.3, 1e9}) {
    TriangleMesh displaced = mesh;
    for (Vec3& vertex : displaced.vertices) vertex += 0.999 * slack * in_cube(random);
    for (int i = 0; i < 50; ++i) {
      const Vec3 point = 2 * in_cube(random);
      const Numbers expected = near_by_force(displaced, point, 0.3);
      const Numbers found = near_point(tree, point, 0.09 * (1 + 0x1p-50), slack);
      EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end())) << slack;
    }
  }
}

TEST(BroadBvhNear, NearestIsFoundWithFewCandidates) {
  std::mt19937_64 random(5);
  const TriangleMesh mesh = scenes::terrain(300, 1, 5);
  const Bvh tree = Bvh::build(mesh);
  WalkCost cost;
  for (int i = 0; i < 100; ++i) {
    Vec3 point = 0.4 * in_cube(random);
    point[2] *= 0.2;
    const auto shorten = [&](std::uint32_t triangle, double limit_m2) {
      return std::min(limit_m2, (mesh.triangle(triangle).a - point).squaredNorm());
    };
    tree.walk_near(point, kInfinity, 0, shorten, cost);
  }
  EXPECT_LT(cost.candidates, 100u * 1500);
}

// ---- building

}  // namespace
}  // namespace collided::engine
