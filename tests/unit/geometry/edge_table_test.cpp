#include <gtest/gtest.h>

#include "server/geometry/edge_table.hpp"
#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/intake/weld.hpp"
#include "tests/oracle/mesh_twins.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

void expect_equal(const EdgeTable& table, const oracle::EdgeUses& truth, const TriangleMesh& mesh,
                  const std::vector<std::uint32_t>& point_of) {
  ASSERT_EQ(table.size(), truth.size());
  std::size_t i = 0;
  for (const auto& [ends, uses] : truth) {
    EXPECT_EQ(table.edges[i].low, ends.first);
    EXPECT_EQ(table.edges[i].high, ends.second);
    const auto got = table.uses_of(i);
    ASSERT_EQ(std::vector<HalfEdge>(got.begin(), got.end()), uses);
    for (std::size_t k = 0; k < uses.size(); ++k) {
      const std::uint32_t from = point_of[mesh.triangles[triangle_of(uses[k])][uses[k] % 3]];
      EXPECT_EQ(table.is_upward[table.edges[i].first_use + k], from == ends.first);
    }
    ++i;
  }
}

TEST(GeometryEdgeTable, ABoxHasEighteenEdgesOfTwoTrianglesRunAlongBothWays) {
  const TriangleMesh box = box_mesh({0, 0, 0}, {1, 2, 3});
  const EdgeTable table = edge_table(box);
  EXPECT_EQ(table.size(), 18u);
  for (std::size_t i = 0; i < table.size(); ++i) {
    EXPECT_EQ(table.uses_of(i).size(), 2u);
    EXPECT_FALSE(table.is_inconsistent(i));
  }
}

TEST(GeometryEdgeTable, AnEmptyMeshHasNone) {
  EXPECT_EQ(edge_table({}).size(), 0u);
  EXPECT_EQ(EdgeTable{}.size(), 0u);
}

TEST(GeometryEdgeTable, AgreesWithAMapOnSoupsWithRepeatedPointsFansAndTrianglesLeftOut) {
  std::mt19937_64 random = oracle::seeded(11);
  for (int round = 0; round < 200; ++round) {
    TriangleMesh mesh;
    const auto vertex_count = static_cast<std::uint32_t>(3 + random() % 40);
    for (std::uint32_t i = 0; i < vertex_count; ++i) {
      mesh.vertices.emplace_back(static_cast<double>(random() % 3), static_cast<double>(random() % 3),
                                 static_cast<double>(random() % 4));
    }
    // A common corner now and then makes a fan of many.
    const bool has_fan = round % 4 == 0;
    std::vector<bool> left_out;
    for (std::uint32_t i = 0; i < 1 + random() % 200; ++i) {
      const auto corner = [&] { return static_cast<std::uint32_t>(random() % vertex_count); };
      mesh.triangles.push_back({has_fan ? 0 : corner(), corner(), corner()});
      left_out.push_back(random() % 8 == 0);
    }
    const std::vector<std::uint32_t> point_of = first_equal_vertices(mesh.vertices);
    expect_equal(edge_table(mesh, point_of, left_out), oracle::edge_uses(mesh, point_of, left_out), mesh, point_of);
  }
}

}  // namespace
}  // namespace collided::engine
