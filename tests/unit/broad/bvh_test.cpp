// Walks of the hierarchy along a ray.
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

TEST(BroadBvhRay, LosesNoTriangleThatTheExactTestMeets) {
  std::mt19937_64 random = oracle::seeded(20240607);
  expect_none_lost(scenes::icosphere(3, 1), 2, 300, random);
  expect_none_lost(scenes::terrain(24, 2, random()), 2, 300, random);
  expect_none_lost(scenes::scattered(1000, 0.1, random()), 2, 300, random);
  expect_none_lost(scenes::scattered(200, 1, random()), 2, 300, random);
  expect_none_lost(scenes::box({1, 1, 1}), 2, 500, random);
  expect_none_lost(scenes::degenerate(1000, random()), 2, 500, random);
}

// A generous walk that offers everything would pass every other test.
TEST(BroadBvhRay, OffersFewTrianglesThatAreNotMet) {
  std::mt19937_64 random(7);
  const TriangleMesh mesh = scenes::terrain(200, 1, 7);
  const Bvh tree = Bvh::build(mesh);
  std::size_t met = 0;
  std::size_t offered = 0;
  for (int i = 0; i < 300; ++i) {
    const Ray ray{0.5 * in_cube(random), in_cube(random)};
    met += met_by(ray, mesh).size();
    offered += along_ray(tree, ray).size();
  }
  EXPECT_LT(static_cast<double>(offered), 1.1 * static_cast<double>(met) + 10);
}

TEST(BroadBvhRay, StartsFarOutLoseNothing) {
  std::mt19937_64 random = oracle::seeded(20240608);
  for (const double far : {1e2, 1e4, 1e7, 1e10, 1e15, 1e20, 1e30, 1e100, 1e200, 1e290}) {
    SCOPED_TRACE(far);
    expect_none_lost(scenes::box({1, 2, 0.5}, {0.25, 0, 0}), far, 200, random);
    expect_none_lost(scenes::icosphere(1, 1), far, 100, random);
  }
}

// The start moves up to the scene with one rounding, so distance costs no sharpness: a ray aimed past the sphere from
// a million radii away offers nothing.
TEST(BroadBvhRay, StartsFarOutStaySharp) {
  const Bvh tree = Bvh::build(scenes::icosphere(4, 1));
  for (const double far : {1e2, 1e4, 1e6, 1e9}) {
    const Vec3 origin(far, 0.25 * far, -0.5 * far);
    const Vec3 side = Vec3(2, 0, 4).normalized();
    EXPECT_TRUE(along_ray(tree, {origin, side * 1.001 - origin}).empty()) << far;
    EXPECT_LT(along_ray(tree, {origin, side * 0.5 - origin}).size(), 12u) << far;
  }
}

TEST(BroadBvhRay, ScalesFromTheSmallestToTheLargestDoublesLoseNothing) {
  std::mt19937_64 random = oracle::seeded(20240609);
  for (const int exponent : {-1060, -1022, -1000, -520, -140, -30, 30, 140, 520, 1000, 1021}) {
    SCOPED_TRACE(exponent);
    TriangleMesh mesh = scenes::icosphere(1, 1);
    scenes::append(mesh, scenes::degenerate(40, random()));
    for (Vec3& vertex : mesh.vertices) {
      for (int axis = 0; axis < 3; ++axis) vertex[axis] = std::ldexp(vertex[axis], exponent);
    }
    expect_none_lost(mesh, exponent > 1000 ? 1 : 2, 60, random);
  }
}

TEST(BroadBvhRay, CoordinatesOverTheWholeRangeInOneMeshLoseNothing) {
  std::mt19937_64 random = oracle::seeded(20240610);
  std::uniform_real_distribution<double> decade(-300, 300);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const double scale = std::pow(10.0, decade(random));
    for (int corner = 0; corner < 3; ++corner) mesh.vertices.push_back(scale * in_cube(random));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  expect_none_lost(mesh, 0.5, 200, random);
}

TEST(BroadBvhRay, DirectionsOfAnyLengthLoseNothing) {
  std::mt19937_64 random = oracle::seeded(20240611);
  const TriangleMesh mesh = scenes::icosphere(2, 1);
  const Bvh tree = Bvh::build(mesh);
  for (const int exponent : {-1074, -1060, -1020, -500, 500, 1020}) {
    for (int i = 0; i < 100; ++i) {
      Ray ray{2 * in_cube(random), in_cube(random)};
      for (int axis = 0; axis < 3; ++axis) ray.direction[axis] = std::ldexp(ray.direction[axis], exponent);
      if (ray.direction.isZero(0)) continue;
      const Numbers expected = met_by(ray, mesh);
      const Numbers found = along_ray(tree, ray);
      EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end())) << exponent;
    }
  }
}

// Components of very different size: the ray runs in a face's plane, or leaves it by less than a float resolves.
TEST(BroadBvhRay, NearlyParallelDirectionsLoseNothing) {
  std::mt19937_64 random = oracle::seeded(20240612);
  const TriangleMesh mesh = scenes::box({1, 1, 1});
  const Bvh tree = Bvh::build(mesh);
  std::size_t met = 0;
  for (const double tilt : {0.0, 1e-320, 1e-200, 1e-30, 1e-19, 1e-18, 1e-17, 1e-16, 1e-10, 1e-7}) {
    for (int i = 0; i < 64; ++i) {
      const int axis = static_cast<int>(random() % 3);
      Ray ray{in_cube(random), in_cube(random)};
      ray.origin[axis] = random() % 2 == 0 ? 1 : -1;
      ray.direction[axis] = random() % 2 == 0 ? tilt : -tilt;
      const Numbers expected = met_by(ray, mesh);
      const Numbers found = along_ray(tree, ray);
      EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end())) << tilt;
      met += expected.size();
    }
  }
  EXPECT_GT(met, 500u);
}

// The exact phase reports a hit at 1 - 2^-53 of this ray; a limit just beyond must keep it, whatever the scale.
TEST(BroadBvhRay, ALimitAtTheHitKeepsIt) {
  std::mt19937_64 random = oracle::seeded(20240613);
  const TriangleMesh mesh = scenes::icosphere(3, 1, {10, 20, 30});
  const Bvh tree = Bvh::build(mesh);
  for (int i = 0; i < 500; ++i) {
    const Vec3 origin = Vec3(10, 20, 30) + std::pow(10.0, i % 12) * in_cube(random);
    const Vec3 target = Vec3(10, 20, 30) + 0.5 * in_cube(random);
    const double length = std::ldexp(1.0, static_cast<int>(random() % 200) - 100);
    const Ray ray{origin, (target - origin) * length};
    for (const std::uint32_t number : met_by(ray, mesh)) {
      RayHit hit;
      cast_ray(ray, mesh.triangle(number), hit);
      const double limit = (hit.distance_m + hit.distance_error_m) / ray.direction.norm() * (1 + 0x1p-50);
      EXPECT_TRUE(along_ray(tree, ray, limit).contains(number));
    }
  }
}

TEST(BroadBvhRay, AShorterLimitEndsTheWalkEarly) {
  const TriangleMesh mesh = scenes::terrain(300, 1, 1);
  const Bvh tree = Bvh::build(mesh);
  const Ray ray{{-0.6, 0.01, 0.0}, {1, 0.01, 0}};
  WalkCost all;
  WalkCost first;
  WalkCost near;
  const auto go_on = [](std::uint32_t, double limit) { return limit; };
  const auto stop = [](std::uint32_t, double) { return -1.0; };
  tree.walk_ray(ray, kInfinity, 0, go_on, all);
  tree.walk_ray(ray, kInfinity, 0, stop, first);
  tree.walk_ray(ray, 0.11, 0, go_on, near);
  EXPECT_EQ(first.candidates, 1u);
  EXPECT_GT(all.candidates, 4u);
  EXPECT_LT(first.nodes, all.nodes);
  EXPECT_LT(near.nodes, all.nodes / 2);
}

TEST(BroadBvhRay, CandidatesComeWithTheMeshsOwnCorners) {
  std::mt19937_64 random(3);
  for (const bool is_float : {false, true}) {
    for (const double offset : {0.0, 100.0, 1e6}) {
      TriangleMesh mesh = scenes::scattered(500, 0.5, 3);
      for (Vec3& vertex : mesh.vertices) {
        vertex += Vec3(offset, -offset, 0.1 * offset);
        for (int axis = 0; axis < 3; ++axis) {
          if (is_float) vertex[axis] = static_cast<double>(static_cast<float>(vertex[axis]));
        }
      }
      const Bvh tree = Bvh::build(mesh);
      std::size_t count = 0;
      const auto check = [&](std::uint32_t number, const Triangle& corners, double limit) {
        const Triangle own = mesh.triangle(number);
        EXPECT_TRUE(own.a == corners.a && own.b == corners.b && own.c == corners.c);
        ++count;
        return limit;
      };
      WalkCost cost;
      for (int i = 0; i < 50; ++i) {
        const Ray ray{Vec3(offset, -offset, 0.1 * offset), in_cube(random)};
        tree.walk_ray(ray, kInfinity, 0, mesh, check, cost);
      }
      EXPECT_GT(count, 100u);
    }
  }
}

// Vertices displaced by up to the slack, each on its own, are what a mover's rounding does to a mesh.
TEST(BroadBvhRay, SlackCoversDisplacedVertices) {
  std::mt19937_64 random = oracle::seeded(20240614);
  const TriangleMesh mesh = scenes::icosphere(2, 1);
  const Bvh tree = Bvh::build(mesh);
  for (const double slack : {1e-14, 1e-9, 1e-5, 1e-2, 0.3, 2.0, 1e9}) {
    TriangleMesh displaced = mesh;
    for (Vec3& vertex : displaced.vertices) vertex += 0.999 * slack * in_cube(random);
    std::size_t met = 0;
    for (int i = 0; i < 100; ++i) {
      const Ray ray = random_ray(displaced, bounds_of(displaced), 2, random);
      const Numbers expected = met_by(ray, displaced);
      const Numbers found = along_ray(tree, ray, kInfinity, slack);
      EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end())) << slack;
      met += expected.size();
    }
    EXPECT_GT(met, 0u);
  }
}

}  // namespace
}  // namespace collided::engine
