#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "server/world/swept_object.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided {
namespace {

TriangleMesh cuboid(const Vec3& half_m) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1).cwiseProduct(half_m));
  }
  constexpr std::uint32_t kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& c : kFaces) {
    mesh.triangles.push_back({c[0], c[1], c[2]});
    mesh.triangles.push_back({c[0], c[2], c[3]});
  }
  return mesh;
}

ObjectInfo mesh_object(TriangleMesh mesh) {
  double radius_m = 0;
  for (const Vec3& v : mesh.vertices) radius_m = std::max(radius_m, v.norm() * (1 + 1e-15));
  auto shared = std::make_shared<const TriangleMesh>(std::move(mesh));
  BspTree tree = BspTree::build(*shared);
  ObjectInfo info;
  info.mesh = std::make_shared<const IndexedMesh>(IndexedMesh{shared, std::move(tree), radius_m});
  return info;
}

ObjectInfo primitive_object(const Primitive& primitive) {
  ObjectInfo info;
  info.primitives = {primitive};
  return info;
}

struct Scene {
  TriangleMesh mesh;
  BspTree tree = BspTree::build(mesh);

  FirstTouch ask(const ObjectInfo& info, const Frame& from, const Frame& to, const SweepOptions& options = {}) const {
    WalkCost cost;
    return first_touch({&info, from, to}, mesh, tree, options, cost);
  }
};

Frame at(const Vec3& position) { return {Mat3::Identity(), position}; }

TEST(WorldSweptObject, ABoxAndTheMeshOfItsSidesMeetAScanAtTheSameTime) {
  std::mt19937_64 generator = oracle::seeded(61);
  std::uniform_real_distribution<double> place(-3, 3);
  const auto point = [&] { return Vec3(place(generator), place(generator), place(generator)); };
  const Scene scene{scenes::icosphere(3, 1)};
  const Vec3 half_m(0.25, 0.5, 0.125);
  const ObjectInfo box = primitive_object(Box{.center = Vec3::Zero(), .half_m = half_m});
  const ObjectInfo mesh = mesh_object(cuboid(half_m));
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 from = 3 * point().normalized();
    const Vec3 to = point();
    const FirstTouch one = scene.ask(box, at(from), at(to));
    const FirstTouch other = scene.ask(mesh, at(from), at(to));
    ASSERT_FALSE(one.undecided || other.undecided);
    ASSERT_EQ(one.yes, other.yes) << i;
    if (!one.yes) continue;
    ++hits;
    ASSERT_LE(one.bracket.low, other.bracket.high);
    ASSERT_GE(one.bracket.high, other.bracket.low);
    ASSERT_LE(one.bracket.high - one.bracket.low, 2e-6);
  }
  EXPECT_GT(hits, 20);
}

TEST(WorldSweptObject, NoKindOfMoverPassesThroughASheet) {
  const Scene sheet{{{{5, -9, -9}, {5, 9, -9}, {5, 0, 9}}, {{0, 1, 2}}}};
  const Vec3 half_m = Vec3::Constant(0x1p-10);
  const Frame to = at({0x1p20, 0, 0});
  for (const ObjectInfo& info : {primitive_object(Box{.center = Vec3::Zero(), .half_m = half_m}),
                                 primitive_object(Capsule{{0, 0, 0}, {0, 0x1p-10, 0}, 0x1p-10}),
                                 primitive_object(Sphere{Vec3::Zero(), 0x1p-10}), mesh_object(cuboid(half_m))}) {
    const double truth = (5 - 0x1p-10) * 0x1p-20;
    const FirstTouch touch = sheet.ask(info, at(Vec3::Zero()), to, {.width = 1e-9});
    ASSERT_TRUE(touch.yes);
    EXPECT_LT(touch.bracket.low, truth);
    EXPECT_GE(touch.bracket.high, truth);
    EXPECT_LE(touch.bracket.high - touch.bracket.low, 1e-9);
    EXPECT_EQ(touch.triangle, 0u);
  }
}

/// A blade from the origin along x sweeps a quarter turn; a wire stands at 45 degrees.
TEST(WorldSweptObject, ATurningBladeMeetsAWireHalfWay) {
  const Scene wire{{{{0.5, 0.5, -1}, {0.5, 0.5, 1}, {0.5, 0.5, 0}}, {{0, 1, 2}}}};
  const ObjectInfo blade = mesh_object({{{0, 0, -0.5}, {1, 0, 0}, {0, 0, 0.5}}, {{0, 1, 2}}});
  const Frame from = at(Vec3::Zero());
  const Frame to{Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ()).toRotationMatrix(), Vec3::Zero()};
  for (const double deviation_m : {1e-2, 1e-4, 1e-6}) {
    const FirstTouch touch = wire.ask(blade, from, to, {.width = 1e-9, .deviation_m = deviation_m});
    ASSERT_TRUE(touch.yes);
    EXPECT_LE(touch.deviation_m, deviation_m);
    EXPECT_GT(touch.deviation_m, 0);
    // The wire is 0.7 m from the axis, where the blade goes 1.1 m in the step.
    EXPECT_NEAR(touch.bracket.high, 0.5, deviation_m / 1.1 + 1e-9);
  }
}

TEST(WorldSweptObject, WhatIsNotOfferedIsUndecided) {
  const Scene sheet{{{{5, -9, -9}, {5, 9, -9}, {5, 0, 9}}, {{0, 1, 2}}}};
  const Frame turned{Eigen::AngleAxisd(1, Vec3::UnitZ()).toRotationMatrix(), Vec3(9, 0, 0)};
  const Frame here = at(Vec3::Zero());
  const ObjectInfo box = primitive_object(Box{.center = Vec3::Zero(), .half_m = {1, 1, 1}});
  EXPECT_TRUE(sheet.ask(box, here, turned).undecided);
  EXPECT_TRUE(sheet.ask(primitive_object(Cylinder{{0, 0, 0}, {1, 0, 0}, 1}), here, at({9, 0, 0})).undecided);
  EXPECT_TRUE(sheet.ask(mesh_object(cuboid({1, 1, 1})), here, turned, {.deviation_m = 1e-12}).undecided);
}

TEST(WorldSweptObject, TimeOfABoxMoverForTheRecord) {
  std::mt19937_64 generator = oracle::seeded(62);
  std::normal_distribution<double> normal;
  const Scene scene{scenes::icosphere(6, 1)};
  const ObjectInfo box = primitive_object(Box{.center = Vec3::Zero(), .half_m = {0.01, 0.02, 0.015}});
  const ObjectInfo mesh = mesh_object(cuboid({0.01, 0.02, 0.015}));
  for (const ObjectInfo* info : {&box, &mesh}) {
    std::vector<double> spent_us;
    int hits = 0;
    double tests = 0;
    for (int i = 0; i < 1000; ++i) {
      const Vec3 outward = Vec3(normal(generator), normal(generator), normal(generator)).normalized();
      const Vec3 step = 0.05 * Vec3(normal(generator), normal(generator), normal(generator)).normalized();
      const auto start = std::chrono::steady_clock::now();
      const FirstTouch touch = scene.ask(*info, at(1.04 * outward), at(1.04 * outward + step));
      spent_us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
      hits += touch.yes;
      tests += touch.exact_tests;
      ASSERT_FALSE(touch.undecided);
    }
    std::sort(spent_us.begin(), spent_us.end());
    std::printf("%zu triangles, step of 50 mm: median %.1f us, p99 %.1f us, %d of 1000 hit, %.1f tests each\n",
                scene.mesh.triangles.size(), spent_us[500], spent_us[990], hits, tests / 1000);
    EXPECT_GT(hits, 100);
  }
}

}  // namespace
}  // namespace collided
