// A sphere or a box asked about on a flat floor of many triangles is told the floor's normal, wherever it lies over edges.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

/// Triangles of unequal sizes, in one plane.
TriangleMesh tessellated_floor() {
  TriangleMesh floor;
  constexpr std::uint32_t kSide = 21;
  for (std::uint32_t i = 0; i < kSide; ++i) {
    for (std::uint32_t j = 0; j < kSide; ++j) {
      const double x = (i - 10.0) + 0.25 * ((i * 7 + j * 3) % 4) / 4;
      const double y = (j - 10.0) + 0.25 * ((i * 5 + j * 11) % 4) / 4;
      floor.vertices.emplace_back(x, y, 0);
    }
  }
  for (std::uint32_t i = 0; i + 1 < kSide; ++i) {
    for (std::uint32_t j = 0; j + 1 < kSide; ++j) {
      const std::uint32_t a = i * kSide + j;
      floor.triangles.push_back({a, a + kSide, a + kSide + 1});
      floor.triangles.push_back({a, a + kSide + 1, a + 1});
    }
  }
  return floor;
}

void expect_floor(const Answers& answers, double depth_m) {
  ASSERT_EQ(answers.hits.size(), 1u);
  ASSERT_LE((answers.hits[0].normal - Vec3(0, 0, -1)).norm(), 1e-12) << answers.hits[0].normal.transpose();
  ASSERT_NEAR(answers.hits[0].distance_m, depth_m, answers.hits[0].error_m + 1e-13);
}

TEST(FlatFloorQuestion, GivesOnlyTheFloorsNormal) {
  for (const bool is_static : {true, false}) {
    extreme::Stage stage;
    if (is_static) stage.load("floor", tessellated_floor());
    else stage.add("floor", extreme::mesh_shape(tessellated_floor()), extreme::at(Vec3::Zero()), false);
    stage.step();
    std::mt19937_64 generator = oracle::seeded(1);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int i = 0; i < 2000; ++i) {
      // Every fourth over a vertex or along an edge between two.
      Vec3 at(7 * any(generator), 7 * any(generator), 0);
      const TriangleMesh floor = i % 4 == 0 ? tessellated_floor() : TriangleMesh{};
      if (i % 4 == 0) at = floor.vertices[static_cast<std::size_t>(220 + i % 17)];
      const double depth_m = 0.01 + 0.005 * any(generator);
      const double radius_m = 0.6 + 0.4 * any(generator);
      expect_floor(stage.ask(QuestionKind::sphere, {at.x(), at.y(), radius_m - depth_m, radius_m}), depth_m);
      const double half = any(generator);
      const Quat turn = Quat(1, 0, 0, half).normalized();
      expect_floor(
          stage.ask(QuestionKind::box, {at.x(), at.y(), 0.5 - depth_m, radius_m, 0.3, 0.5, turn.w(), 0, 0, turn.z()}),
          depth_m);
      if (testing::Test::HasFatalFailure()) FAIL() << "at " << at.transpose() << " question " << i;
    }
  }
}

}  // namespace
}  // namespace collided::engine
