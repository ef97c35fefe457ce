#include "server/exact_phase/solid/winding_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/oracle/seed.hpp"
#include "tests/oracle/solid_oracle.hpp"
#include "tests/oracle/winding_oracle.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/planted.hpp"

namespace collided::engine {
namespace {

/// A box without the two triangles of its top.
TriangleMesh box_without_lid() {
  TriangleMesh mesh = scenes::box({1, 1, 1});
  std::erase_if(mesh.triangles, [&](const TriangleCorners& t) {
    return mesh.vertices[t[0]].z() == 1 && mesh.vertices[t[1]].z() == 1 && mesh.vertices[t[2]].z() == 1;
  });
  return mesh;
}

/// Without every n-th triangle: a scan with holes.
TriangleMesh with_holes(TriangleMesh mesh, std::size_t every) {
  std::vector<TriangleCorners> kept;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (i % every != 0) kept.push_back(mesh.triangles[i]);
  }
  mesh.triangles = kept;
  return mesh;
}

TriangleMesh moved(TriangleMesh mesh, double factor, const Vec3& by) {
  for (Vec3& vertex : mesh.vertices) vertex = factor * vertex + by;
  return mesh;
}

WindingSide side(const WindingTree& tree, const Vec3& point) {
  std::uint32_t nodes = 0;
  return tree.side(point, 0, nodes);
}

TEST(ExactWinding, ABoxWithoutLidHoldsWhatLiesDeepInIt) {
  const TriangleMesh open = box_without_lid();
  ASSERT_EQ(open.triangles.size(), 10u);
  const WindingTree tree(open);
  std::uint32_t nodes = 0;
  // Seen from its middle the lid is one face of six.
  const Bounded middle = tree.around({0, 0, 0}, 0, 0.5, nodes);
  EXPECT_NEAR(middle.value, 5.0 / 6, middle.bound());
  EXPECT_LT(middle.bound(), 1e-13);
  EXPECT_EQ(side(tree, {0, 0, 0}), WindingSide::in);
  EXPECT_EQ(side(tree, {0, 0, -0.99}), WindingSide::in);
  EXPECT_EQ(side(tree, {0, 0, 1.01}), WindingSide::out) << "above the opening";
  EXPECT_EQ(side(tree, {1.01, 0, 0}), WindingSide::out);
  // In the opening the walls and the floor are seen as exactly half of all there is to see.
  EXPECT_EQ(side(tree, {0.25, 0.5, 1}), WindingSide::undecided);
  EXPECT_EQ(side(tree, {1, 0, 0}), WindingSide::undecided) << "on the surface the number jumps";
}

TEST(ExactWinding, APointThatIsKnownRoughlyIsDecidedOnlyWhereAllItMayBeAgree) {
  const WindingTree tree(box_without_lid());
  std::uint32_t nodes = 0;
  EXPECT_EQ(tree.side({0.5, 0, 0}, 0.01, nodes), WindingSide::in);
  EXPECT_EQ(tree.side({0.995, 0, 0}, 0.01, nodes), WindingSide::undecided);
  EXPECT_EQ(tree.side({1.005, 0, 0}, 0.01, nodes), WindingSide::undecided);
  EXPECT_EQ(tree.side({1.5, 0, 0}, 0.01, nodes), WindingSide::out);
}

/// Random points about the mesh: the bound holds for every width, and no decided side is another than that of the sum.
void expect_bounds(const char* name, const TriangleMesh& mesh, std::mt19937_64& random, int count) {
  SCOPED_TRACE(name);
  Aabb box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  const WindingTree tree(mesh);
  std::uniform_real_distribution<double> any(-0.2, 1.2);
  int decided = 0;
  int in = 0;
  for (int i = 0; i < count; ++i) {
    const Vec3 share(any(random), any(random), any(random));
    const Vec3 point = box.low + share.cwiseProduct(box.high - box.low);
    const auto truth = static_cast<double>(oracle::winding_by_sum(mesh, point));
    const double own = 1e-15 * (1 + static_cast<double>(mesh.triangles.size()) * 1e-3);
    for (const double widest : {0.5, 0.35, 0.1, 0.0}) {
      std::uint32_t nodes = 0;
      const Bounded found = tree.around(point, 0, widest, nodes);
      ASSERT_LE(std::abs(found.value - truth), found.bound() + own) << widest << ": " << point.transpose();
    }
    const WindingSide found = side(tree, point);
    const bool is_in_bounds = (share.array() >= 0).all() && (share.array() <= 1).all();
    if (found == WindingSide::in) { ASSERT_TRUE(truth > 0.5 - own && is_in_bounds) << point.transpose(); }
    if (found == WindingSide::out) { ASSERT_TRUE(truth <= 0.5 + own || !is_in_bounds) << point.transpose(); }
    decided += found != WindingSide::undecided ? 1 : 0;
    in += found == WindingSide::in ? 1 : 0;
  }
  EXPECT_GE(decided, count - 1 - count / 500) << "a random point is hardly ever within the bound of 1/2";
  EXPECT_GT(in, count / 20);
}

TEST(ExactWinding, TheBoundHoldsForMeshesWithHoles) {
  std::mt19937_64 random = oracle::seeded(61);
  const char* asked = std::getenv("COLLIDED_WINDING_POINTS");
  const int count = asked != nullptr ? std::atoi(asked) : 400;
  const TriangleMesh rough = scenes::rough_sphere(3, random);
  expect_bounds("box without lid", box_without_lid(), random, count);
  expect_bounds("sphere with holes", with_holes(scenes::icosphere(3, 1), 7), random, count);
  expect_bounds("rough sphere with holes", with_holes(rough, 5), random, count);
  expect_bounds("far off", moved(with_holes(rough, 5), 1, {1e5, -3e5, 7e4}), random, count);
  expect_bounds("tiny", moved(with_holes(rough, 5), 1e-250, {0, 0, 0}), random, count);
  expect_bounds("huge", moved(with_holes(rough, 5), 1e250, {0, 0, 0}), random, count);
}

// Where a mesh closes, the number is whole, and above 1/2 is where rays in rationals say inside.
TEST(ExactWinding, OfAClosedMeshItIsTheExactSide) {
  std::mt19937_64 random = oracle::seeded(62);
  for (const TriangleMesh& mesh : {scenes::box({1, 2, 3}), scenes::icosphere(2, 1), scenes::rough_sphere(2, random)}) {
    const WindingTree tree(mesh);
    const oracle::SolidOracle exact(mesh);
    std::uniform_real_distribution<double> any(-1.5, 1.5);
    for (int i = 0; i < 300; ++i) {
      const Vec3 point(any(random), any(random), any(random));
      const WindingSide found = side(tree, point);
      ASSERT_NE(found, WindingSide::undecided) << point.transpose();
      ASSERT_EQ(found == WindingSide::in, exact.side(oracle::rational(point), random) == SolidSide::in)
          << point.transpose();
    }
    for (int i = 0; i < 100; ++i) {
      const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
      const Vec3 on = (t.a + t.b) / 2;
      if (exact.side(oracle::rational(on), random) != SolidSide::on) continue;
      ASSERT_EQ(side(tree, on), WindingSide::undecided) << on.transpose();
    }
  }
}

TEST(ExactWinding, WhatHasNoTriangleOrNoAreaHoldsNothing) {
  EXPECT_EQ(side(WindingTree(TriangleMesh{}), {0, 0, 0}), WindingSide::out);
  TriangleMesh needle;
  needle.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  needle.triangles = {{0, 1, 2}};
  EXPECT_EQ(side(WindingTree(needle), {0.5, 1, 0}), WindingSide::out);
  // Two-sided flat sheet: the two halves cancel.
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_EQ(side(WindingTree(sheet), {0.2, 0.2, 0.1}), WindingSide::out);
}

}  // namespace
}  // namespace collided::engine
