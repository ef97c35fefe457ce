// A millimetre of wall at a kilometre a second is crossed in a microsecond: sampling poses sees the ball before and
// behind it, and Bullet without continuous detection lets all of them through.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine::thin_wall_test {
namespace {

constexpr double kHalfWall = 0x1p-11;  // about half a millimetre
constexpr double kRadius = 0x1p-7;

void expect_crossing(const std::vector<Event>& events, double seconds_before_end) {
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].kind, EventKind::began);
  EXPECT_EQ(events[1].kind, EventKind::ended);
  EXPECT_EQ(events[0].of.episode, events[1].of.episode);
  EXPECT_GE(events[0].bracket_low_s, seconds_before_end);
  EXPECT_LE(events[0].bracket_high_s, seconds_before_end);
  EXPECT_LE(events[0].bracket_low_s - events[0].bracket_high_s, 2e-9);
}

/// The ball starts 512 m before the wall and ends 512 m behind it a second later.
void shoot(extreme::Stage& stage) {
  const ObjectId ball = stage.ball("ball", {-512, 0.25, 0.125}, kRadius);
  stage.step();
  const double first_touch = (512 - kHalfWall - kRadius) / 1024;
  stage.move(ball, extreme::at({512, 0.25, 0.125}));
  expect_crossing(stage.step(), 1 - first_touch);
  stage.move(ball, extreme::at({-512, 0.25, 0.125}));
  expect_crossing(stage.step(), 1 - first_touch);
}

TEST(ExtremeThinWall, ABoxAMeshAndASceneStopTheBallInTime) {
  const Vec3 half(kHalfWall, 2, 2);
  extreme::Stage box, mesh, scene;
  box.block("wall", {0, 0, 0}, half);
  shoot(box);
  mesh.add("wall", extreme::mesh_shape(scenes::box(half)), extreme::at({0, 0, 0}));
  shoot(mesh);
  scene.load("wall", scenes::box(half));
  shoot(scene);
}

TEST(ExtremeThinWall, AWallWithoutThicknessAtEverySpeed) {
  for (int power = 0; power <= 200; power += 10) {
    const double reach = std::ldexp(1.0, power);
    extreme::Stage stage;
    stage.block("sheet", {0, 0, 0}, {0, 2, 2});
    const ObjectId point = stage.ball("point", {-reach, 0, 0}, 0);
    stage.step();
    stage.move(point, extreme::at({reach, 0, 0}));
    EXPECT_EQ(stage.step().size(), 2u) << "2^" << power << " m/s";
  }
}

TEST(ExtremeThinWall, OneStepBesideTheEdgeNothingIsMet) {
  for (const double summand : {0.0, 0x1p-51}) {
    extreme::Stage stage;
    stage.block("wall", {0, 0, 0}, {kHalfWall, 2, 2});
    const ObjectId ball = stage.ball("ball", {-512, 2 + kRadius + summand, 0}, kRadius);
    stage.step();
    stage.move(ball, extreme::at({512, 2 + kRadius + summand, 0}));
    EXPECT_EQ(stage.step().size(), summand == 0 ? 2u : 0u) << summand;
  }
}

// A thousand walls in a row, each with its own two events, in order of the walls' ids.
TEST(ExtremeThinWall, EveryWallOfAThousandIsReported) {
  extreme::Stage stage;
  for (int i = 0; i < 1'000; ++i) stage.block("wall" + std::to_string(i), {i - 500.0, 0, 0}, {kHalfWall, 1, 1});
  const ObjectId ball = stage.ball("ball", {-512, 0, 0}, kRadius);
  stage.step();
  stage.move(ball, extreme::at({512, 0, 0}));
  EXPECT_EQ(stage.step().size(), 2'000u);
  EXPECT_TRUE(stage.world.contacts().empty());
}

}  // namespace
}  // namespace collided::engine::thin_wall_test
