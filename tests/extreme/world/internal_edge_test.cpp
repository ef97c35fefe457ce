// A ball that rolls over a flat floor of many triangles bumps into the edges between them wherever a neighbour's edge
// is taken for a wall: the normal tips, in Jolt and Bullet alike.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::internal_edge_test {
namespace {

/// n x n unit squares from the corner -n/2, two triangles each, at the height.
TriangleMesh tiles(int n, double height) {
  TriangleMesh mesh;
  const auto width = static_cast<std::uint32_t>(n + 1);
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) mesh.vertices.push_back({x - n / 2.0, y - n / 2.0, height});
  }
  for (std::uint32_t y = 0; y + 1 < width; ++y) {
    for (std::uint32_t x = 0; x + 1 < width; ++x) {
      const std::uint32_t i = y * width + x;
      mesh.triangles.push_back({i, i + 1, i + width + 1});
      mesh.triangles.push_back({i, i + width + 1, i + width});
    }
  }
  return mesh;
}

TEST(ExtremeInternalEdge, ARollingBallFeelsOneFlatFloor) {
  for (const double slant : {0.0, 0.0625, 1.0}) {
    extreme::Stage stage;
    stage.load("floor", tiles(16, 0));
    const ObjectId ball = stage.ball("ball", {-7, -7 * slant, 0.5 - 0x1p-7}, 0.5);
    ASSERT_EQ(stage.step().size(), 1u);
    for (double x = -7; x <= 7; x += 0.0625) {
      stage.move(ball, extreme::at({x, x * slant, 0.5 - 0x1p-7}));
      ASSERT_TRUE(stage.step().empty()) << "one contact all the way";
      const Contact& contact = stage.world.contacts().at(0).contact;
      ASSERT_NEAR(std::abs(contact.normal.z()), 1, 1e-15) << x;
      ASSERT_NEAR(contact.depth_m, 0x1p-7, 1e-15) << x;
    }
  }
}

TEST(ExtremeInternalEdge, RaysAndBallsSeeTheSameNormalOnEveryEdgeAndCorner) {
  extreme::Stage stage;
  stage.load("floor", tiles(16, 3));
  stage.step();
  for (double x = -8; x <= 8; x += 0.5) {
    for (double y = -8; y <= 8; y += 0.5) {
      const Answers ray = stage.ray({x, y, 5}, {0, 0, -1});
      ASSERT_TRUE(extreme::is_hit(ray)) << x << " " << y;
      ASSERT_EQ(ray.hits[0].distance_m, 2);
      ASSERT_EQ(ray.hits[0].normal, Vec3(0, 0, 1));
      const Answers ball = stage.ask(QuestionKind::sphere, {x, y, 3.5, 0.75});
      ASSERT_NEAR(ball.hits.at(0).normal.z(), -1, 1e-15);
      ASSERT_NEAR(ball.hits[0].distance_m, 0.25, 1e-15);
    }
  }
}

TEST(ExtremeInternalEdge, OnTheFloorsOwnBorderTheBallStillStands) {
  extreme::Stage stage;
  stage.load("floor", tiles(16, 0));
  stage.step();
  const Answers corner = stage.ask(QuestionKind::sphere, {8, 8, 0.5, 0.75});
  ASSERT_TRUE(extreme::is_hit(corner));
  EXPECT_NEAR(corner.hits[0].normal.z(), -1, 1e-15);
  EXPECT_NEAR(corner.hits[0].distance_m, 0.25, 1e-15);
}

}  // namespace
}  // namespace collided::engine::internal_edge_test
