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

namespace collided::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Numbers = std::set<std::uint32_t>;

/// Every candidate of a walk that never shortens.
Numbers along_ray(const Bvh& tree, const Ray& ray, double limit = kInfinity, double slack_m = 0) {
  Numbers all;
  WalkCost cost;
  const auto collect = [&](std::uint32_t triangle, double current) {
    all.insert(triangle);
    return current;
  };
  tree.walk_ray(ray, limit, slack_m, collect, cost);
  EXPECT_EQ(all.empty(), cost.candidates == 0);
  return all;
}

Vec3 in_cube(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return {x, y, coordinate(random)};
}

Aabb bounds_of(const TriangleMesh& mesh) {
  Aabb bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  return bounds;
}

/// Through points of triangles, their corners and edges, or at random; from `far` scene sizes away; some with zero
/// components, some starting on what they aim at.
Ray random_ray(const TriangleMesh& mesh, const Aabb& bounds, double far, std::mt19937_64& random) {
  const Triangle triangle = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
  const Vec3 center = bounds.low / 2 + bounds.high / 2;
  const Vec3 half = bounds.high / 2 - bounds.low / 2;
  Vec3 target = center + half.cwiseProduct(in_cube(random));
  switch (random() % 5) {
    case 0: target = triangle.a; break;
    case 1: target = triangle.a / 2 + triangle.b / 2; break;
    case 2: target = triangle.a / 3 + triangle.b / 3 + triangle.c / 3; break;
    case 3: target = triangle.c; break;
    default: break;
  }
  Vec3 origin = center + far * half.maxCoeff() * in_cube(random);
  const std::uint64_t zeros = random() % 8;
  if (zeros < 3) origin[static_cast<int>(zeros)] = target[static_cast<int>(zeros)];
  if (zeros == 3) origin[0] = target[0], origin[1] = target[1];
  if (zeros == 4) origin = target;
  Ray ray{origin, target - origin};
  if (ray.direction.isZero(0)) ray.direction = in_cube(random);
  if (zeros < 3 && random() % 2 == 0) ray.direction[static_cast<int>(zeros)] = -0.0;
  return ray;
}

/// Triangles that the ray meets, decided exactly.
Numbers met_by(const Ray& ray, const TriangleMesh& mesh) {
  Numbers all;
  RayHit hit;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (cast_ray(ray, mesh.triangle(i), hit).yes()) all.insert(i);
  }
  return all;
}

struct Count {
  std::size_t met = 0;
  std::size_t candidates = 0;
};

Count expect_none_lost(const TriangleMesh& mesh, double far, int ray_count, std::mt19937_64& random) {
  const Bvh tree = Bvh::build(mesh);
  const Aabb bounds = bounds_of(mesh);
  Count count;
  for (int i = 0; i < ray_count; ++i) {
    const Ray ray = random_ray(mesh, bounds, far, random);
    const Numbers expected = met_by(ray, mesh);
    const Numbers found = along_ray(tree, ray);
    EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end()))
        << "ray " << i << std::hexfloat << " from " << ray.origin.transpose() << " along " << ray.direction.transpose();
    count.met += expected.size();
    count.candidates += found.size();
  }
  EXPECT_GT(count.met, 0u);
  return count;
}

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

// ---- boxes and points

Aabb bounds_of(const Triangle& t) { return {t.a.cwiseMin(t.b).cwiseMin(t.c), t.a.cwiseMax(t.b).cwiseMax(t.c)}; }

Numbers in_box(const Bvh& tree, const Aabb& asked) {
  Numbers all;
  WalkCost cost;
  const auto collect = [&](std::uint32_t triangle) {
    all.insert(triangle);
    return true;
  };
  tree.walk_box(asked, collect, cost);
  return all;
}

Numbers in_box_by_force(const TriangleMesh& mesh, const Aabb& asked) {
  Numbers all;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (overlaps(bounds_of(mesh.triangle(i)), asked)) all.insert(i);
  }
  return all;
}

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

Numbers near_point(const Bvh& tree, const Vec3& point, double limit_m2, double slack_m = 0) {
  Numbers all;
  WalkCost cost;
  const auto collect = [&](std::uint32_t triangle, double limit) {
    all.insert(triangle);
    return limit;
  };
  tree.walk_near(point, limit_m2, slack_m, collect, cost);
  return all;
}

bool box_near(const Aabb& box, const Vec3& point, double limit_m) {
  return (box.low - point).cwiseMax(point - box.high).cwiseMax(0.0).stableNorm() <= limit_m;
}

/// Triangles surely within the limit, by the exact phase; boxes spare it the far ones.
Numbers near_by_force(const TriangleMesh& mesh, const Vec3& point, double limit_m) {
  Numbers all;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle triangle = mesh.triangle(i);
    if (!box_near(bounds_of(triangle), point, limit_m * (1 + 1e-9))) continue;
    const Closest nearest = closest(point, triangle);
    if (nearest.distance_m + nearest.distance_error_m <= limit_m) all.insert(i);
  }
  return all;
}

/// Triangles whose bounds are within the limit: what a walk over boxes could tell.
std::size_t boxes_near(const TriangleMesh& mesh, const Vec3& point, double limit_m) {
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    count += box_near(bounds_of(mesh.triangle(i)), point, limit_m);
  }
  return count;
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

TEST(BroadBvhBuild, EmptyMeshHasNoCandidates) {
  const Bvh tree = Bvh::build(TriangleMesh{});
  EXPECT_TRUE(along_ray(tree, {Vec3::Zero(), Vec3::UnitX()}).empty());
  EXPECT_TRUE(in_box(tree, {Vec3::Constant(-1), Vec3::Constant(1)}).empty());
  EXPECT_TRUE(near_point(tree, Vec3::Zero(), kInfinity).empty());
  EXPECT_TRUE(tree.bounds().empty());
  EXPECT_TRUE(along_ray(Bvh(), {Vec3::Zero(), Vec3::UnitX()}).empty());
}

TEST(BroadBvhBuild, OneTriangleIsALeafAtTheRoot) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  mesh.triangles = {{0, 1, 2}};
  const Bvh tree = Bvh::build(mesh);
  EXPECT_EQ(along_ray(tree, {{0.25, 0.25, 0}, {0, 0, 1}}).size(), 1u);
  EXPECT_TRUE(along_ray(tree, {{0.75, 0.75, 0}, {0, 0, 1}}).empty());
  EXPECT_TRUE(along_ray(tree, {{0.25, 0.25, 0}, {0, 0, -1}}).empty());
  EXPECT_EQ(tree.bounds().low, Vec3(0, 0, 1));
}

TEST(BroadBvhBuild, AHundredThousandEqualTrianglesEnd) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles.assign(100'000, {0, 1, 2});
  const Bvh tree = Bvh::build(mesh);
  EXPECT_LT(tree.report().depth, 12u);
  EXPECT_EQ(along_ray(tree, {{0.25, 0.25, 1}, {0, 0, -1}}).size(), 100'000u);
  EXPECT_TRUE(along_ray(tree, {{0.75, 0.75, 1}, {0, 0, -1}}).empty());
}

// Each size half of the one before: a cut by area takes one triangle at a time.
TEST(BroadBvhBuild, AGeometricSeriesStaysWithinTheDepth) {
  TriangleMesh mesh;
  for (int i = 0; i < 2000; ++i) {
    const double x = std::ldexp(1.0, -(i % 1000));
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {{x, 0, 0}, {0, x, 0}, {0, 0, x}});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const Bvh tree = Bvh::build(mesh);
  EXPECT_LE(tree.report().depth, 60u);
  EXPECT_EQ(along_ray(tree, {{1, 1, 1}, {-1, -1, -1}}).size(), 2000u);
}

TEST(BroadBvhBuild, ThreadsDoNotChangeTheAnswersOrTheirOrder) {
  const TriangleMesh mesh = scenes::terrain(150, 1, 9);
  const auto order = [&](unsigned threads) {
    const Bvh tree = Bvh::build(mesh, {.threads = threads, .progress = {}, .cancelled = {}});
    std::vector<std::uint32_t> all;
    std::mt19937_64 random(9);
    WalkCost cost;
    const auto collect = [&](std::uint32_t triangle, double limit) {
      all.push_back(triangle);
      return limit;
    };
    for (int i = 0; i < 200; ++i) tree.walk_ray({in_cube(random), in_cube(random)}, kInfinity, 0, collect, cost);
    return all;
  };
  const std::vector<std::uint32_t> one = order(1);
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(one, order(2));
  EXPECT_EQ(one, order(7));
}

TEST(BroadBvhBuild, ProgressRisesToOne) {
  const TriangleMesh mesh = scenes::terrain(150, 1, 9);
  std::vector<double> seen;
  Bvh::build(mesh, {.threads = 2, .progress = [&](double done) { seen.push_back(done); }, .cancelled = {}});
  ASSERT_GT(seen.size(), 2u);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_GE(seen.front(), 0.0);
  EXPECT_EQ(seen.back(), 1.0);
}

TEST(BroadBvhBuild, CancellingLeavesAnEmptyTree) {
  const TriangleMesh mesh = scenes::terrain(150, 1, 9);
  for (int asked_before = 0; asked_before < 20; asked_before += 5) {
    int asked = 0;
    const Bvh tree =
        Bvh::build(mesh, {.threads = 2, .progress = {}, .cancelled = [&] { return asked++ >= asked_before; }});
    EXPECT_TRUE(tree.bounds().empty());
    EXPECT_EQ(tree.report().references, 0u);
    EXPECT_TRUE(along_ray(tree, {Vec3(0, 0, 1), Vec3(0, 0, -1)}).empty());
  }
}

TEST(BroadBvhBuild, TreeAndMeshStayUnder160BytesATriangle) {
  const TriangleMesh mesh = scenes::terrain(300, 1, 9);
  const Bvh tree = Bvh::build(mesh);
  const std::size_t mesh_bytes = mesh.vertices.size() * sizeof(Vec3) + mesh.triangles.size() * sizeof(TriangleCorners);
  EXPECT_LE(tree.report().bytes + mesh_bytes, 160 * mesh.triangles.size());
  EXPECT_EQ(tree.report().references, mesh.triangles.size());
}

// Each instruction set this machine has, down to plain C++, against the exact test; the walks differ in nothing else.
TEST(BroadBvhSimd, EveryInstructionSetLosesNothing) {
  std::mt19937_64 random = oracle::seeded(20240618);
  TriangleMesh mesh = scenes::icosphere(2, 1);
  scenes::append(mesh, scenes::degenerate(200, random()));
  const Bvh tree = Bvh::build(mesh);
  std::vector<std::int64_t> targets = {HWY_SCALAR, HWY_EMU128};
  for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) targets.push_back(rest & -rest);
  for (const std::int64_t target : targets) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    std::mt19937_64 same = random;
    for (int i = 0; i < 100; ++i) {
      const Ray ray = random_ray(mesh, tree.bounds(), 2, same);
      const Numbers expected = met_by(ray, mesh);
      const Numbers found = along_ray(tree, ray);
      EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end()))
          << hwy::TargetName(target);
      const Vec3 point = 2 * in_cube(same);
      const Numbers close = near_by_force(mesh, point, 0.5);
      const Numbers offered = near_point(tree, point, 0.25);
      EXPECT_TRUE(std::includes(offered.begin(), offered.end(), close.begin(), close.end()));
      const Aabb asked{point - Vec3::Constant(0.3), point};
      const Numbers overlapping = in_box_by_force(mesh, asked);
      const Numbers found_in_box = in_box(tree, asked);
      EXPECT_TRUE(std::includes(found_in_box.begin(), found_in_box.end(), overlapping.begin(), overlapping.end()));
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace
}  // namespace collided::engine
