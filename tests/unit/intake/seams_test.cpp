#include <gtest/gtest.h>

#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/mesh/seams.hpp"
#include "server/intake/weld.hpp"
#include "tests/oracle/mesh_twins.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/planted.hpp"

namespace collided::engine {
namespace {

/// Two squares side by side at x = 1; the left one's border has a point that the right one lacks, moved by so much.
TriangleMesh squares(double off_m) {
  return {{{0, 0, 0}, {1, 0, 0}, {1 + off_m, 0.4, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}},
          {{0, 1, 2}, {0, 2, 4}, {2, 3, 4}, {1, 5, 6}, {1, 6, 3}}};
}

// A6
TEST(IntakeSeams, ATVertexIsNamedWithTheSideThatLacksIt) {
  const MeshHealth health = examine(squares(0));
  ASSERT_EQ(health.seams.size(), 1u);
  EXPECT_EQ(health.seams[0].kind, Seam::Kind::t_vertex);
  EXPECT_EQ(health.seams[0].point, 2u);
  EXPECT_EQ(health.seams[0].edge, 3u * 4 + 2);  // of the last triangle, from corner 3 to corner 1
  EXPECT_EQ(health.seams[0].gap_m, 0);
}

// A4
TEST(IntakeSeams, CracksAreFoundAtTheWidthThatIsStated) {
  const double reach_m = examine(squares(0)).seam_reach.crack_m;
  EXPECT_NEAR(reach_m, 1e-4 * std::sqrt(5), 1e-12);
  ASSERT_EQ(examine(squares(0.99 * reach_m)).crack_count(), 1u);
  EXPECT_EQ(examine(squares(0.99 * reach_m)).seams[0].kind, Seam::Kind::beside_edge);
  EXPECT_EQ(examine(squares(-0.99 * reach_m)).crack_count(), 1u);
  EXPECT_EQ(examine(squares(1.01 * reach_m)).seams.size(), 0u);
  EXPECT_EQ(examine(squares(1.01 * reach_m), 2 * reach_m).crack_count(), 1u);
}

TEST(IntakeSeams, TVerticesOfSinglePrecisionAreFound) {
  std::mt19937_64 random = oracle::seeded(31);
  for (int round = 0; round < 200; ++round) {
    TriangleMesh mesh = squares(0);
    const Vec3 shift = 1000 * Vec3::Random();
    const Mat3 turn = Quat::UnitRandom().toRotationMatrix();
    const double at = std::uniform_real_distribution<double>(0.3, 0.7)(random);
    mesh.vertices[2] = (1 - at) * mesh.vertices[1] + at * mesh.vertices[3];
    for (Vec3& v : mesh.vertices) v = Vec3((turn * v + shift).cast<float>().cast<double>());
    const MeshHealth health = examine(mesh);
    ASSERT_EQ(health.t_vertex_count(), 1u);
    ASSERT_EQ(health.crack_count(), 0u);
  }
}

// The cells of a fine net are no wider than the reach: its neighbours are its own detail.
TEST(IntakeSeams, FineDetailIsNoCrack) {
  const TriangleMesh fine = scenes::terrain(30, 1, 4);
  EXPECT_EQ(examine(fine, 0.05).seams.size(), 0u);
}

TEST(IntakeSeams, TwoPatchesWithPointsOfTheirOwnAlongTheSeamAreTiedPointByPoint) {
  TriangleMesh patches = scenes::terrain(10, 1, 4);
  TriangleMesh other = patches;
  for (Vec3& v : other.vertices) v[0] = 1.00001 - v[0];  // mirrored at the border x = 0.5, ten micrometres off
  for (TriangleCorners& t : other.triangles) std::swap(t[0], t[1]);
  scenes::append(patches, other);
  const MeshHealth health = examine(patches);
  EXPECT_EQ(health.crack_count(), 11u);
  for (const Seam& seam : health.seams) EXPECT_EQ(seam.kind, Seam::Kind::beside_point);
}

// Long triangles across each other: every border is near every point, and looking ends where it is said to.
TEST(IntakeSeams, ASoupOfLongTrianglesEndsAndTellsWhatWasNotSeen) {
  const TriangleMesh soup = scenes::scattered(2000, 1, 6);
  const MeshHealth health = examine(soup);
  EXPECT_EQ(health.seam_unseen_count, 0u);
  SeamReach reach = health.seam_reach;
  reach.max_tests = 100'000;
  const std::vector<std::uint32_t> points = first_equal_vertices(soup.vertices);
  const Seams seams = find_seams(soup, health.edges, points, reach, health.bounds);
  EXPECT_GT(seams.unseen_count, 0u);
  EXPECT_LT(seams.unseen_count, soup.vertices.size());
}

void expect_equal(const std::vector<Seam>& got, const std::vector<Seam>& truth) {
  ASSERT_EQ(got.size(), truth.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(got[i].kind, truth[i].kind);
    EXPECT_EQ(got[i].point, truth[i].point);
    EXPECT_EQ(got[i].gap_m, truth[i].gap_m);
    if (got[i].kind == Seam::Kind::beside_point) {
      EXPECT_EQ(got[i].other_point, truth[i].other_point);
    } else {
      EXPECT_EQ(got[i].edge, truth[i].edge);
    }
  }
}

TEST(IntakeSeams, AgreeWithAllPointsAgainstAllBorders) {
  std::mt19937_64 random = oracle::seeded(32);
  std::uniform_real_distribution<double> spread(-1, 1);
  for (int round = 0; round < 60; ++round) {
    TriangleMesh mesh = round % 2 == 0 ? scenes::plant(scenes::rough_sphere(3, random), 4, 1e-3, random).mesh
                                       : scenes::scattered(60, 0.5, random());
    // Some corners onto others' edges and corners, nearly.
    for (int i = 0; i < 40; ++i) {
      const auto number = [&] { return random() % mesh.vertices.size(); };
      const Vec3 target = mesh.vertices[number()];
      const Vec3 end = random() % 2 == 0 ? target : mesh.vertices[number()];
      mesh.vertices[number()] =
          target + 0.5 * (spread(random) + 1) * (end - target) + 1e-4 * spread(random) * Vec3::Ones();
    }
    const MeshHealth health = examine(mesh, 3e-4);
    expect_equal(health.seams, oracle::seams(mesh, health.seam_reach));
  }
}

}  // namespace
}  // namespace collided::engine
