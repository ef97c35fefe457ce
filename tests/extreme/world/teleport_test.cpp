// A jump has no way between: sweeping it would report everything that lies on the line, and not sweeping a motion would
// tunnel. The flag alone tells them apart.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::teleport_test {
namespace {

TEST(ExtremeTeleport, AJumpThroughAWallMeetsNothingAndAMotionDoes) {
  for (const double reach : {1.0, 1e3, 1e12, 1e150}) {
    extreme::Stage stage;
    stage.block("wall", {0, 0, 0}, {reach * 0x1p-20, reach, reach});
    const ObjectId ball = stage.ball("ball", {-reach, 0, 0}, reach * 0x1p-10);
    stage.step();
    stage.move(ball, extreme::at({reach, 0, 0}), true);
    EXPECT_TRUE(stage.step().empty()) << reach;
    stage.move(ball, extreme::at({-reach, 0, 0}), false);
    EXPECT_EQ(stage.step().size(), 2u) << reach;
  }
}

TEST(ExtremeTeleport, OutOfAContactEndsItWithItsReason) {
  extreme::Stage stage;
  stage.block("wall", {0, 0, 0}, {1, 1, 1});
  const ObjectId ball = stage.ball("ball", {2, 0, 0}, 1);
  ASSERT_EQ(stage.step().size(), 1u) << "it touches from the start";
  stage.move(ball, extreme::at({std::nextafter(2, 3), 0, 0}), true);
  ASSERT_EQ(stage.step().size(), 1u);
  EXPECT_EQ(stage.world.events()[0].kind, EventKind::ended);
  EXPECT_EQ(stage.world.events()[0].reason, EndReason::teleported);
  stage.move(ball, extreme::at({2, 0, 0}), true);
  ASSERT_EQ(stage.step().size(), 1u);
  EXPECT_EQ(stage.world.events()[0].kind, EventKind::began);
  stage.move(ball, extreme::at({3, 0, 0}), false);
  ASSERT_EQ(stage.step().size(), 1u);
  EXPECT_EQ(stage.world.events()[0].reason, EndReason::separated);
}

TEST(ExtremeTeleport, WithinAContactNothingHappens) {
  extreme::Stage stage;
  stage.block("wall", {0, 0, 0}, {1, 1, 1});
  const ObjectId ball = stage.ball("ball", {2, 0, 0}, 1);
  stage.step();
  for (const Vec3& to : {Vec3(-2, 0, 0), Vec3(0, 2, 0), Vec3(0, 0, 0), Vec3(2, 0, 0)}) {
    stage.move(ball, extreme::at(to), true);
    EXPECT_TRUE(stage.step().empty()) << "it touches there too";
  }
}

// A thousand jumps between a trillion metres and the wall's own face.
TEST(ExtremeTeleport, ThereAndBackAThousandTimes) {
  extreme::Stage stage;
  stage.block("wall", {0, 0, 0}, {1, 1, 1});
  const ObjectId ball = stage.ball("ball", {1e12, 0, 0}, 1);
  stage.step();
  std::size_t began = 0, ended = 0;
  for (int i = 0; i < 1'000; ++i) {
    stage.move(ball, extreme::at({i % 2 == 0 ? 2.0 : 1e12, 0, 0}), true);
    stage.step();
    began += extreme::count_of(stage.world.events(), EventKind::began);
    ended += extreme::count_of(stage.world.events(), EventKind::ended);
  }
  EXPECT_EQ(began, 500u);
  EXPECT_EQ(ended, 500u);
}

}  // namespace
}  // namespace collided::engine::teleport_test
