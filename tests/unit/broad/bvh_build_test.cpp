// Building the hierarchy; the same answers on every instruction set.
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
