// A millimetre part posed a thousand kilometres out: placing it rounds, and what is decided is the rounded world, alike
// for events, questions and the twin that tests every pair.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::pose_rounding_test {
namespace {

TEST(ExtremePoseRounding, BoxesThatKissFarOutAreDecidedForTheirPlacedCorners) {
  for (const double far : {1e6, 1e8, 1e12}) {
    const double step = std::nextafter(far, 2 * far) - far;
    for (const double gap : {-step, 0.0, step}) {
      extreme::Stage stage;
      stage.block("left", {far, 0, 0}, {1, 1, 1});
      const ObjectId right = stage.block("right", {far + 2 + gap, 0, 0}, {1, 1, 1});
      EXPECT_EQ(stage.step().size(), gap <= 0 ? 1u : 0u) << far << " " << gap;
      stage.move(right, extreme::at({far + 2 - gap, 0, 0}), true);
      stage.step();
      EXPECT_EQ(stage.world.contacts().size(), gap >= 0 ? 1u : 0u);
    }
  }
}

// A gap smaller than a step of the coordinates is gone once the pose is a double: touching, and truly so.
TEST(ExtremePoseRounding, AGapBelowTheStepIsNoGap) {
  extreme::Stage stage;
  stage.block("left", {1e6, 0, 0}, {1, 1, 1});
  stage.block("right", {1e6 + 2 + 1e-11, 0, 0}, {1, 1, 1});
  stage.step();
  ASSERT_EQ(stage.world.contacts().size(), 1u);
  EXPECT_EQ(stage.world.contacts()[0].contact.depth_m, 0);
}

// In its own frame the gap lives: 1e-10 within a mesh about the origin is lost by placing it at 1e8.
TEST(ExtremePoseRounding, DetailsSurviveInTheirOwnFrameAndRoundInTheWorld) {
  TriangleMesh steps;
  steps.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {-1, -1, 1e-10}, {1, -1, 1e-10}, {0, 1, 1e-10}};
  steps.triangles = {{0, 1, 2}, {3, 4, 5}};
  for (const double far : {0.0, 1e8}) {
    extreme::Stage stage;
    stage.add("steps", extreme::mesh_shape(steps), extreme::at({0, 0, far}));
    stage.step();
    const Answers found = stage.ray({0, 0, far + 1}, {0, 0, -1});
    ASSERT_TRUE(extreme::is_hit(found));
    EXPECT_EQ(found.hits[0].triangle, far == 0 ? 1u : 0u) << "at 1e8 both are one plane, and the lower number wins";
    EXPECT_EQ(found.hits[0].distance_m, far == 0 ? 1 - 1e-10 : 1);
  }
}

TEST(ExtremePoseRounding, EventsAndTheTwinAgreeOnEveryTurnedPair) {
  extreme::Stage stage;
  for (int i = 0; i < 40; ++i) {
    const Quat turned = Quat(1 + i % 5, i % 3, i % 7, 1).normalized();
    stage.add("part" + std::to_string(i), extreme::box_shape({1e-3, 2e-3, 3e-3}),
              extreme::at({1e6 + i * 2.5e-3, -1e6 + (i % 4) * 1e-3, 0}, turned));
  }
  stage.step();
  EXPECT_GT(stage.world.contacts().size(), 20u) << "the scene must be worth testing";
  EXPECT_EQ(extreme::open_pairs(stage.world), oracle::touching_pairs(*stage.world.newest()));
}

}  // namespace
}  // namespace collided::engine::pose_rounding_test
