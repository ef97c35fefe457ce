#include <fmt/format.h>
#include <gtest/gtest.h>

#include "server/intake/mesh/mesh_health.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/planted.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

using Numbers = std::set<std::uint32_t>;
using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Numbers as_set(const std::vector<std::uint32_t>& numbers) { return {numbers.begin(), numbers.end()}; }

Numbers points(const std::vector<Seam>& seams, Seam::Kind kind) {
  Numbers points;
  for (const Seam& seam : seams) {
    if (seam.kind == kind) points.insert(seam.point);
  }
  return points;
}

Pairs pairs(const std::vector<Seam>& seams) {
  Pairs pairs;
  for (const Seam& seam : seams) {
    if (seam.kind == Seam::Kind::beside_point)
      pairs.insert({std::min(seam.point, seam.other_point), std::max(seam.point, seam.other_point)});
  }
  return pairs;
}

Pairs ends(const TriangleMesh& mesh, const std::vector<HalfEdge>& halves) {
  Pairs pairs;
  for (const HalfEdge half : halves) {
    const TriangleCorners& corners = mesh.triangles[triangle_of(half)];
    const std::uint32_t from = corners[half % 3];
    const std::uint32_t to = corners[(half % 3 + 1) % 3];
    pairs.insert({std::min(from, to), std::max(from, to)});
  }
  return pairs;
}

// A4, A6: precision and recall are 1 for every kind of defect, all of them in one mesh.
TEST(IntakePlantedDefects, AreFoundWithoutExceptionAndNothingElseIs) {
  std::mt19937_64 random = oracle::seeded(21);
  for (int round = 0; round < 12; ++round) {
    const double crack_m = round % 3 == 0 ? 1e-3 : round % 3 == 1 ? 1e-6 : 1e-9;
    const scenes::Planted planted = scenes::plant(scenes::rough_sphere(5, random), 40, crack_m, random);
    const MeshHealth health = examine(planted.mesh, crack_m);
    ASSERT_EQ(points(health.seams, Seam::Kind::t_vertex), planted.t_vertices);
    ASSERT_EQ(points(health.seams, Seam::Kind::beside_edge), planted.cracks_at_edges);
    ASSERT_EQ(pairs(health.seams), planted.cracks_at_points);
    ASSERT_EQ(as_set(health.flipped), planted.flipped);
    ASSERT_EQ(as_set(health.duplicates), planted.duplicates);
    ASSERT_EQ(as_set(health.zero_area), planted.without_area);
    ASSERT_EQ(ends(planted.mesh, health.nonmanifold_edges), planted.edges_of_many);
  }
}

TEST(IntakePlantedDefects, ACleanMeshHasNone) {
  std::mt19937_64 random = oracle::seeded(22);
  const MeshHealth health = examine(scenes::rough_sphere(5, random));
  EXPECT_TRUE(health.is_closed && health.is_consistently_oriented && health.is_manifold());
  EXPECT_EQ(health.seams.size() + health.flipped.size() + health.duplicates.size() + health.zero_area.size(), 0u);
}

// A3: polygons of four to eight corners on a circle, some with two neighbouring corners exchanged.
TEST(IntakePlantedDefects, EveryBowtieIsCountedAndNoOtherPolygon) {
  std::mt19937_64 random = oracle::seeded(23);
  for (int round = 0; round < 20; ++round) {
    std::string text;
    std::uint64_t bowties = 0;
    int vertices = 0;
    for (int polygon = 0; polygon < 60; ++polygon) {
      const int corners = 4 + static_cast<int>(random() % 5);
      const double turn = std::uniform_real_distribution<double>(0, 6)(random);
      for (int i = 0; i < corners; ++i) {
        const double angle = turn + 2 * 3.14159265358979 * i / corners;
        text += fmt::format("v {} {} {}\n", std::cos(angle) + 5 * polygon, std::sin(angle), 0.3 * std::cos(angle));
      }
      std::vector<int> order(corners);
      for (int i = 0; i < corners; ++i) order[i] = vertices + i + 1;
      if (random() % 4 == 0) {
        const std::size_t at = random() % corners;
        std::swap(order[at], order[(at + 1) % corners]);
        ++bowties;
      }
      text += "f";
      for (const int corner : order) text += fmt::format(" {}", corner);
      text += '\n';
      vertices += corners;
    }
    const LoadReport report = test::load("bowties.obj", text).report;
    std::uint64_t told = 0;
    for (const std::string& line : report.mended) {
      if (line.find("cross") != std::string::npos) told += std::stoull(line);
    }
    ASSERT_EQ(told, bowties);
  }
}

}  // namespace
}  // namespace collided::engine
