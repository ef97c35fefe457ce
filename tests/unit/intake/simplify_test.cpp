#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/aabb.hpp"
#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/simplify/simplify.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

CollapseOrder simplified(const TriangleMesh& mesh, CollapseCost cost = CollapseCost::quadric) {
  SimplifyReport report;
  return simplify(mesh, {.cost = cost}, report);
}

/// Pairs of triangles that meet without a common corner, all against all.
std::size_t crossing_pairs(const TriangleMesh& mesh) {
  std::size_t count = 0;
  std::vector<Aabb> boxes;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) boxes.push_back(bounds(mesh.triangle(i)));
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::uint32_t k = 0; k < i; ++k) {
      const TriangleCorners& a = mesh.triangles[i];
      const TriangleCorners& b = mesh.triangles[k];
      const bool joined =
          std::any_of(a.begin(), a.end(), [&](std::uint32_t c) { return std::count(b.begin(), b.end(), c) > 0; });
      if (!joined && overlaps(boxes[i], boxes[k]) && overlaps(mesh.triangle(i), mesh.triangle(k)).yes()) ++count;
    }
  }
  return count;
}

Vec3 normal_of(const TriangleMesh& mesh, std::uint32_t i) {
  const Triangle t = mesh.triangle(i);
  return (t.b - t.a).cross(t.c - t.a);
}

/// Two sheets a hair apart, bent alike: to collapse without a look around is to push one through the other.
TriangleMesh two_sheets() {
  TriangleMesh lower = scenes::terrain(24, 10, 5);
  TriangleMesh upper = lower;
  for (Vec3& v : upper.vertices) v[2] += 0.05;
  scenes::append(lower, upper);
  return lower;
}

// A17, A18: what the guards promise, on surfaces that tempt to break it.
TEST(IntakeSimplify, NoNormalTurnsBy90DegreesAndNothingNewCrosses) {
  for (const TriangleMesh& mesh : {scenes::terrain(32, 10, 3), scenes::icosphere(4, 1), two_sheets()}) {
    ASSERT_EQ(crossing_pairs(mesh), 0u);
    for (const CollapseCost cost : {CollapseCost::quadric, CollapseCost::edge_length}) {
      const CollapseOrder order = simplified(mesh, cost);
      for (const double share : {0.5, 0.1, 0.02}) {
        const auto target = static_cast<std::size_t>(share * static_cast<double>(mesh.triangles.size()));
        const LevelTriangles level = level_with(mesh, order, target);
        const TriangleMesh simpler{mesh.vertices, level.triangles};
        EXPECT_EQ(crossing_pairs(simpler), 0u) << share;
        for (std::uint32_t i = 0; i < level.triangles.size(); ++i) {
          ASSERT_GT(normal_of(simpler, i).dot(normal_of(mesh, level.originals[i])), 0) << share;
        }
      }
    }
  }
}

// Without the guard a sheet goes through the other one; this shows that the scene above can tell.
TEST(IntakeSimplify, TheCrossingGuardHasWorkToDo) {
  SimplifyReport report;
  simplify(two_sheets(), {}, report);
  EXPECT_GT(report.crossing_refusals, 0u);
  EXPECT_GT(report.flip_refusals, 0u);
}

// A17: the inner vertex's nearest neighbour, 0, does not see the edge from 2 to 3; going there would turn that triangle over.
TEST(IntakeSimplify, ACollapseThatWouldFlipATriangleIsRefused) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {2, -2, 0}, {1, 0.5, 0}, {3, 1, 0}, {0, 3, 0}, {0.35, 0.45, 0}};
  mesh.triangles = {{0, 1, 5}, {1, 2, 5}, {2, 3, 5}, {3, 4, 5}, {4, 0, 5}};
  SimplifyReport report;
  const CollapseOrder order = simplify(mesh, {.cost = CollapseCost::edge_length}, report);
  EXPECT_GT(report.flip_refusals, 0u);
  for (std::size_t steps = 0; steps <= order.size(); ++steps) {
    const LevelTriangles level = level_after(mesh, order, steps);
    const TriangleMesh simpler{mesh.vertices, level.triangles};
    for (std::uint32_t i = 0; i < level.triangles.size(); ++i) EXPECT_GT(normal_of(simpler, i)[2], 0);
  }
}

// A14: as many triangles as are asked for, within one per cent.
TEST(IntakeSimplify, AnyNumberOfTrianglesIsReached) {
  const TriangleMesh mesh = scenes::terrain(64, 10, 8);
  const CollapseOrder order = simplified(mesh);
  std::mt19937_64 random = oracle::seeded(14);
  for (int i = 0; i < 200; ++i) {
    const std::size_t target = 200 + random() % (mesh.triangles.size() - 200);
    const std::size_t got = level_with(mesh, order, target).triangles.size();
    EXPECT_LE(got, target);
    EXPECT_GE(static_cast<double>(got), 0.99 * static_cast<double>(target) - 1);
  }
}

TEST(IntakeSimplify, EveryLevelIsWhatTheStepsLeave) {
  const TriangleMesh mesh = scenes::icosphere(3, 1);
  const CollapseOrder order = simplified(mesh);
  ASSERT_EQ(flaw_of(order, mesh.vertices.size()), "");
  std::vector<std::uint32_t> stands_for(mesh.vertices.size());
  for (std::uint32_t i = 0; i < stands_for.size(); ++i) stands_for[i] = i;
  for (std::size_t steps = 0; steps <= order.size(); steps += 7) {
    std::vector<TriangleCorners> expected;
    for (TriangleCorners t : mesh.triangles) {
      for (std::uint32_t& corner : t) {
        for (std::size_t s = 0; s < steps; ++s) corner = corner == order[s].removed ? order[s].kept : corner;
      }
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) expected.push_back(t);
    }
    const LevelTriangles level = level_after(mesh, order, steps);
    ASSERT_EQ(level.triangles, expected) << steps;
    const TriangleMesh compact = compact_mesh(mesh, level);
    for (std::uint32_t i = 0; i < compact.triangles.size(); ++i) {
      ASSERT_EQ(compact.triangle(i).b, mesh.vertices[level.triangles[i][1]]);
    }
    EXPECT_EQ(level_with(mesh, order, level.triangles.size()).triangles, expected) << steps;
  }
}

TEST(IntakeSimplify, ClosedStaysClosedAndPiecesStayPieces) {
  TriangleMesh mesh = scenes::icosphere(3, 1);
  scenes::append(mesh, scenes::icosphere(3, 0.3, {3, 0, 0}));
  const TriangleMesh simplest = compact_mesh(mesh, level_with(mesh, simplified(mesh), 0));
  const MeshHealth health = examine(simplest);
  EXPECT_TRUE(health.is_closed);
  EXPECT_TRUE(health.is_consistently_oriented);
  EXPECT_EQ(health.component_count, 2u);
  EXPECT_LT(simplest.triangles.size(), 40u);
}

// A box of 6 faces of 2 n^2 triangles is a box of 12 without being off at all: flat faces cost nothing, creases do.
TEST(IntakeSimplify, ABoxOfManyTrianglesBecomesOneOfTwelve) {
  TriangleMesh mesh;
  constexpr int n = 8;
  for (int face = 0; face < 6; ++face) {
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < n; ++k) {
        const auto corner = [&](int u, int v) {
          Vec3 p;
          p[face / 2] = face % 2;
          p[(face / 2 + 1) % 3] = (face % 2 == 1 ? u : v) / static_cast<double>(n);
          p[(face / 2 + 2) % 3] = (face % 2 == 1 ? v : u) / static_cast<double>(n);
          mesh.vertices.push_back(p);
          return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
        };
        const std::uint32_t a = corner(i, k), b = corner(i + 1, k), c = corner(i + 1, k + 1), d = corner(i, k + 1);
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      }
    }
  }
  const TriangleMesh simpler = compact_mesh(mesh, level_with(mesh, simplified(mesh), 12));
  ASSERT_EQ(simpler.triangles.size(), 12u) << "equal vertices count as one";
  for (const Vec3& v : simpler.vertices) EXPECT_TRUE(((v.array() == 0) || (v.array() == 1)).all()) << v.transpose();
  EXPECT_TRUE(examine(simpler).is_closed);
}

TEST(IntakeSimplify, VerticesBetweenPartsStay) {
  const TriangleMesh mesh = scenes::terrain(16, 10, 2);
  const std::vector<std::uint32_t> part_ends{static_cast<std::uint32_t>(mesh.triangles.size() / 2),
                                             static_cast<std::uint32_t>(mesh.triangles.size())};
  std::set<std::uint32_t> first, second, both;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t c : mesh.triangles[i]) (i < part_ends[0] ? first : second).insert(c);
  }
  std::set_intersection(first.begin(), first.end(), second.begin(), second.end(), std::inserter(both, both.end()));
  ASSERT_GT(both.size(), 10u);
  SimplifyReport report;
  for (const EdgeCollapse& step : simplify(mesh, {.part_ends = part_ends}, report))
    EXPECT_FALSE(both.contains(step.removed));
}

TEST(IntakeSimplify, OddMeshesComeThroughWhole) {
  for (const TriangleMesh& mesh :
       {TriangleMesh{}, scenes::degenerate(500, 3), scenes::scattered(300, 0.1, 4), scenes::box({1, 1, 1})}) {
    SimplifyReport report;
    const CollapseOrder order = simplify(mesh, {}, report);
    EXPECT_EQ(flaw_of(order, mesh.vertices.size()), "");
    EXPECT_EQ(crossing_pairs({mesh.vertices, level_with(mesh, order, 0).triangles}) > crossing_pairs(mesh), false);
  }
  EXPECT_NE(flaw_of({{0, 1}, {1, 0}}, 2), "");
  EXPECT_NE(flaw_of({{0, 1}, {0, 2}}, 3), "");
  EXPECT_NE(flaw_of({{0, 3}}, 3), "");
  EXPECT_NE(flaw_of({{2, 2}}, 3), "");
}

TEST(IntakeSimplify, FarFromTheOriginTheSameCollapsesAreTaken) {
  TriangleMesh near = scenes::icosphere(3, 1);
  for (Vec3& v : near.vertices) v = (v * 0x1p20).array().round() * 0x1p-20;
  TriangleMesh far = near;
  for (Vec3& v : far.vertices) v += Vec3(0x1p22, -0x1p21, 0x1p22);
  const TriangleMesh simpler = compact_mesh(far, level_with(far, simplified(far), 200));
  EXPECT_TRUE(examine(simpler).is_closed);
  EXPECT_LE(simpler.triangles.size(), 200u);
  for (const Vec3& v : simpler.vertices) EXPECT_NEAR((v - Vec3(0x1p22, -0x1p21, 0x1p22)).norm(), 1, 1e-6);
}

}  // namespace
}  // namespace collided::engine
