#include <gtest/gtest.h>

#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/world/objects/self_intersections.hpp"
#include "tests/oracle/mesh_twins.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

std::vector<TrianglePair> found(const TriangleMesh& mesh) { return self_intersections(mesh, Bvh::build(mesh)).pairs; }

TEST(WorldSelfIntersections, ClosedSurfacesWithoutFoldsHaveNone) {
  EXPECT_TRUE(found(box_mesh({0, 0, 0}, {1, 2, 3})).empty());
  EXPECT_TRUE(found(scenes::icosphere(3, 1)).empty());
  EXPECT_TRUE(found(scenes::terrain(20, 10, 5)).empty());
}

// A flat grid: all neighbours lie in one plane, which is where a test with a tolerance goes wrong.
TEST(WorldSelfIntersections, AFlatGridHasNoneInAnyPlane) {
  for (const Vec3& slope : {Vec3(0, 0, 0), Vec3(0.25, 0.5, 0), Vec3(0.1, 0.3, 0)}) {
    TriangleMesh grid = scenes::terrain(8, 1, 3);
    for (Vec3& v : grid.vertices) v[2] = slope[0] * v[0] + slope[1] * v[1];
    EXPECT_EQ(found(grid), oracle::self_intersections(grid));
    if (slope[0] != 0.1) { EXPECT_TRUE(found(grid).empty()); }
  }
}

TEST(WorldSelfIntersections, AFoldOverAnEdgeIsOne) {
  const TriangleMesh fold{{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.4, 0.5, 0}}, {{0, 1, 2}, {1, 0, 3}}};
  EXPECT_EQ(found(fold), (std::vector<TrianglePair>{{0, 1}}));
  TriangleMesh lifted = fold;
  lifted.vertices[3][2] = 1e-300;
  EXPECT_TRUE(found(lifted).empty());
}

TEST(WorldSelfIntersections, ATriangleThatPassesThroughItsNeighbourAtACornerIsOne) {
  // The second one's far side goes through the first one's inside.
  const TriangleMesh pierced{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}, {1, 1, -1}}, {{0, 1, 2}, {0, 3, 4}}};
  EXPECT_EQ(found(pierced).size(), 1u);
  TriangleMesh summand = pierced;
  summand.vertices[3] = {-1, -1, 1};
  summand.vertices[4] = {-1, -1, -1};
  EXPECT_TRUE(found(summand).empty());
}

TEST(WorldSelfIntersections, ATouchOfAVertexCounts) {
  const TriangleMesh touch{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {1, 1, 1}, {2, 1, 1}}, {{0, 1, 2}, {3, 4, 5}}};
  EXPECT_EQ(found(touch).size(), 1u);
}

TEST(WorldSelfIntersections, AgreesWithAllPairsInRationals) {
  std::mt19937_64 random = oracle::seeded(14);
  for (int round = 0; round < 40; ++round) {
    TriangleMesh mesh;
    // Few different points make many shared corners, planes and touches.
    const auto coordinate = [&] { return static_cast<double>(random() % 5) * (round % 2 == 0 ? 0.25 : 0.1); };
    for (int i = 0; i < 14; ++i) mesh.vertices.emplace_back(coordinate(), coordinate(), coordinate());
    for (int i = 0; i < 40; ++i) {
      const auto corner = [&] { return static_cast<std::uint32_t>(random() % 14); };
      mesh.triangles.push_back({corner(), corner(), corner()});
    }
    ASSERT_EQ(found(mesh), oracle::self_intersections(mesh)) << round;
  }
}

}  // namespace
}  // namespace collided::engine
