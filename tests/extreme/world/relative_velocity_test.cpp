// How fast two bodies close where they touch, from nothing but their accepted poses.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::relative_velocity_test {
namespace {

const Event& began_of(const extreme::Stage& stage) {
  const std::vector<Event>& events = stage.world.events();
  EXPECT_EQ(extreme::count_of(events, EventKind::began), 1u);
  EXPECT_EQ(events.at(0).kind, EventKind::began);
  return events.at(0);
}

TEST(ExtremeRelativeVelocity, AMoverAgainstWhatRestsAndTheOtherWayRound) {
  extreme::Stage stage;
  stage.block("wall", {0, 0, 0}, {1, 9, 9});
  const ObjectId ball = stage.ball("ball", {-16, 0, 0}, 1);
  stage.step();
  stage.move(ball, extreme::at({-1.5, 0.25, 0}));
  stage.step();
  EXPECT_EQ(began_of(stage).relative_velocity, Vec3(14.5, 0.25, 0)) << "of the ball, b, against the wall";
  extreme::Stage turned;
  const ObjectId first = turned.ball("ball", {-16, 0, 0}, 1);
  turned.block("wall", {0, 0, 0}, {1, 9, 9});
  turned.step();
  turned.move(first, extreme::at({-1.5, 0.25, 0}));
  turned.step();
  EXPECT_EQ(began_of(turned).relative_velocity, Vec3(-14.5, -0.25, 0));
}

TEST(ExtremeRelativeVelocity, TwoMoversAndOneThatPassesThrough) {
  extreme::Stage stage;
  const ObjectId a = stage.block("a", {-8, 0, 0}, {0.5, 0.5, 0.5});
  const ObjectId b = stage.block("b", {8, 0, 0}, {0.5, 0.5, 0.5});
  stage.step();
  stage.move(a, extreme::at({8, 0, 0}));
  stage.move(b, extreme::at({-8, 0, 0}));
  stage.step();
  EXPECT_EQ(began_of(stage).relative_velocity, Vec3(-32, 0, 0));
  EXPECT_EQ(stage.world.events().at(1).relative_velocity, Vec3::Zero()) << "an end has none";
}

// A rod of 2 m about its middle, a quarter turn a second: its end comes down on the peg at r = 0.875 m.
TEST(ExtremeRelativeVelocity, ATurnCountsAtThePoint) {
  extreme::Stage stage;
  stage.ball("peg", {0, 0.875, 0}, 0x1p-10);
  const ObjectId rod = stage.add("rod", extreme::box_shape({1, 0x1p-10, 0x1p-10}), extreme::at({0, 0, 0}));
  stage.step();
  stage.move(rod, extreme::at({0, 0, 0}, Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ()))));
  stage.step();
  const Vec3 velocity = began_of(stage).relative_velocity;
  EXPECT_NEAR(velocity.x(), -M_PI / 2 * 0.875, 0.01);
  EXPECT_NEAR(velocity.y(), 0, 0.01);
}

// Whoever sent no pose for this step is still under way for as long as its last way took; then it rests.
TEST(ExtremeRelativeVelocity, WhoIsSilentRests) {
  for (const int silent : {0, 1, 2}) {
    extreme::Stage stage;
    const ObjectId target = stage.block("target", {0, 0, 0}, {1, 1, 1});
    const ObjectId ball = stage.ball("ball", {0.25, 0, 9}, 1);
    stage.step();
    stage.move(target, extreme::at({0.25, 0, 0}));
    for (int i = 0; i <= silent; ++i) {
      stage.move(ball, extreme::at({0.25, 0, 9}));
      stage.step();
    }
    stage.move(ball, extreme::at({0.25, 0, 1.5}));
    stage.step();
    EXPECT_EQ(began_of(stage).relative_velocity, Vec3(silent == 0 ? -0.25 : 0, 0, -7.5)) << silent;
  }
}

TEST(ExtremeRelativeVelocity, AJumpIsNoMotion) {
  extreme::Stage stage;
  stage.block("wall", {0, 0, 0}, {1, 9, 9});
  const ObjectId ball = stage.ball("ball", {-16, 0, 0}, 1);
  stage.step();
  stage.move(ball, extreme::at({-1.5, 0, 0}), true);
  stage.step();
  EXPECT_EQ(began_of(stage).relative_velocity, Vec3::Zero());
}

}  // namespace
}  // namespace collided::engine::relative_velocity_test
