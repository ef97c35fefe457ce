#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "server/exact_phase/edge_kinds.hpp"
#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/intake/weld.hpp"
#include "tests/oracle/mesh_twins.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine::edge_kinds_test {
namespace {

std::size_t count(const TriangleMesh& mesh, const EdgeView& view, EdgeKind kind) {
  const std::vector<std::uint8_t> kinds = edge_kinds(mesh, edge_table(mesh), view);
  return static_cast<std::size_t>(
      std::count_if(kinds.begin(), kinds.end(), [&](std::uint8_t k) { return (k & kind) != 0; }));
}

double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180); }

// A61
TEST(ExactEdgeKinds, AnOpenBoxHasFourBoundaryEdgesAndAClosedOneNone) {
  TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(count(box, {}, kBoundaryEdge), 0u);
  std::erase_if(box.triangles, [&](const TriangleCorners& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t corner) { return box.vertices[corner][2] == 1; });
  });
  EXPECT_EQ(count(box, {}, kBoundaryEdge), 4u);
}

// A62
TEST(ExactEdgeKinds, ACubeHasTwelveCreasesAtSixtyDegreesAndASphereNone) {
  EXPECT_EQ(count(box_mesh({0, 0, 0}, {1, 1, 1}), {.crease_cosine = cosine(60)}, kCreaseEdge), 12u);
  EXPECT_EQ(count(scenes::icosphere(3, 1), {.crease_cosine = cosine(60)}, kCreaseEdge), 0u);
}

// A62: a right angle is more than the angle of cosine 2^-60 and no more than the one of cosine 0.
TEST(ExactEdgeKinds, ARightAngleIsComparedExactly) {
  const TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(count(box, {.crease_cosine = 0x1p-60}, kCreaseEdge), 12u);
  EXPECT_EQ(count(box, {.crease_cosine = 0}, kCreaseEdge), 0u);
  EXPECT_EQ(count(box, {.crease_cosine = -0x1p-60}, kCreaseEdge), 0u);
}

// A62: what is turned over folds as its neighbour does, seen the right way round.
TEST(ExactEdgeKinds, ATurnedTriangleMakesNoCreaseOfAFlatEdge) {
  TriangleMesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  EXPECT_EQ(count(square, {}, kCreaseEdge), 0u);
  std::swap(square.triangles[1][1], square.triangles[1][2]);
  EXPECT_EQ(count(square, {}, kCreaseEdge), 0u);
}

// A63
TEST(ExactEdgeKinds, ACubeOfTwoMaterialsHasItsBordersAndNoOthers) {
  const TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  std::vector<std::uint32_t> material(12, 0);
  for (std::uint32_t i = 0; i < 12; ++i) {
    const Triangle t = box.triangle(i);
    material[i] = t.a[2] == 1 && t.b[2] == 1 && t.c[2] == 1 ? 1 : 0;
  }
  const EdgeTable table = edge_table(box);
  const std::vector<std::uint8_t> kinds = edge_kinds(box, table, {.material = material});
  std::size_t found = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Vec3& low = box.vertices[table.edges[i].low];
    const Vec3& high = box.vertices[table.edges[i].high];
    // The four sides of the lid: on top, and along one axis.
    const bool is_rim = low[2] == 1 && high[2] == 1 && (low[0] == high[0] || low[1] == high[1]);
    EXPECT_EQ((kinds[i] & kMaterialEdge) != 0, is_rim);
    found += is_rim ? 1 : 0;
  }
  EXPECT_EQ(found, 4u);
}

/// How many silhouette edges meet at each point; those of a closed mesh are loops.
std::map<std::uint32_t, int> silhouette_degrees(const TriangleMesh& mesh, const Vec3& eye) {
  const EdgeTable table = edge_table(mesh);
  const std::vector<std::uint8_t> kinds = edge_kinds(mesh, table, {.eye = eye});
  std::map<std::uint32_t, int> degrees;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if ((kinds[i] & kSilhouetteEdge) == 0) continue;
    ++degrees[table.edges[i].low];
    ++degrees[table.edges[i].high];
  }
  return degrees;
}

// A64
TEST(ExactEdgeKinds, ABoxFromAGeneralEyeHasSixSilhouetteEdgesInOneLoop) {
  const std::map<std::uint32_t, int> degrees = silhouette_degrees(box_mesh({0, 0, 0}, {1, 2, 3}), {5, 7, 11});
  EXPECT_EQ(degrees.size(), 6u);  // six points with two edges each, and a box has no two separate loops of three
  for (const auto& [point, degree] : degrees) EXPECT_EQ(degree, 2);
}

// A64: eyes in the planes of faces and on vertices too, where a sign in double would come out either way.
TEST(ExactEdgeKinds, SilhouettesOfClosedMeshesAreLoopsFromEverywhere) {
  std::mt19937_64 random = oracle::seeded(12);
  const TriangleMesh sphere = scenes::icosphere(2, 1, {0.1, 0.2, 0.3});
  const TriangleMesh box = box_mesh({0, 0, 0}, {1, 2, 3});
  std::uniform_real_distribution<double> spread(-3, 3);
  for (int round = 0; round < 300; ++round) {
    const TriangleMesh& mesh = round % 2 == 0 ? sphere : box;
    const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
    const Vec3 in_plane = t.a + spread(random) * (t.b - t.a) + spread(random) * (t.c - t.a);
    const Vec3 eye = round % 3 == 0   ? in_plane
                     : round % 3 == 1 ? t.a
                                      : Vec3(spread(random), spread(random), spread(random));
    for (const auto& [point, degree] : silhouette_degrees(mesh, eye)) ASSERT_EQ(degree % 2, 0) << eye.transpose();
  }
}

TEST(ExactEdgeKinds, AgreeWithRationalsOnSoupsOfSmallNumbers) {
  std::mt19937_64 random = oracle::seeded(13);
  for (int round = 0; round < 60; ++round) {
    TriangleMesh mesh;
    for (int i = 0; i < 12; ++i) {
      const auto coordinate = [&] { return static_cast<double>(random() % 4) + (round % 2 == 0 ? 0 : 0.1); };
      mesh.vertices.emplace_back(coordinate(), coordinate(), coordinate());
    }
    std::vector<std::uint32_t> material;
    for (int i = 0; i < 40; ++i) {
      const auto corner = [&] { return static_cast<std::uint32_t>(random() % 12); };
      mesh.triangles.push_back({corner(), corner(), corner()});
      material.push_back(static_cast<std::uint32_t>(random() % 2));
    }
    const std::vector<std::uint32_t> point_of = first_equal_vertices(mesh.vertices);
    const std::vector<bool> left_out(mesh.triangles.size(), false);
    const double limit = std::array{0.5, 0.0, -0.5, 1.0, 0.7071067811865476, cosine(60)}[round % 6];
    const Vec3 eye(static_cast<double>(random() % 6), static_cast<double>(random() % 6),
                   static_cast<double>(random() % 6));
    const EdgeTable table = edge_table(mesh, point_of);
    const std::vector<std::uint8_t> kinds =
        edge_kinds(mesh, table, {.crease_cosine = limit, .material = material, .eye = eye});
    std::size_t i = 0;
    for (const auto& [ends, uses] : oracle::edge_uses(mesh, point_of, left_out)) {
      ASSERT_EQ(kinds[i++], oracle::edge_kind(mesh, point_of, uses, limit, material, eye))
          << ends.first << ' ' << ends.second;
    }
  }
}

}  // namespace
}  // namespace collided::engine::edge_kinds_test
