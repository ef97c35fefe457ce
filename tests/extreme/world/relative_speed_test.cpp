// Two bodies at a billion metres a second side by side, closing at a nanometre: a sweep of each alone meets nothing or
// everything; what counts is the difference, and it is the last digits of both.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::relative_speed_test {
namespace {

/// Both fly by `speed`; b, one radius sum and a bit behind a in y, closes by `closing`.
std::size_t events_of_a_flight(double speed, double gap, double closing) {
  extreme::Stage stage;
  const ObjectId a = stage.ball("a", {0, 0, 0}, 1);
  const ObjectId b = stage.ball("b", {0, 2 + gap, 0}, 1);
  EXPECT_TRUE(stage.step().empty());
  stage.move(a, extreme::at({speed, 0, 0}));
  stage.move(b, extreme::at({speed, 2 + gap - closing, 0}));
  return stage.step().size();
}

TEST(ExtremeRelativeSpeed, EqualVelocitiesNeverMeet) {
  for (const double speed : {1.0, 1e3, 1e9, 1e15}) {
    EXPECT_EQ(events_of_a_flight(speed, 0x1p-51, 0), 0u) << speed;
    EXPECT_EQ(events_of_a_flight(speed, 1, 0), 0u) << speed;
  }
}

TEST(ExtremeRelativeSpeed, ANanometreASecondDecides) {
  for (const double speed : {0.0, 1.0, 1e9}) {
    EXPECT_EQ(events_of_a_flight(speed, 0x1p-30, 0x1p-30), 1u) << "touching at the end";
    EXPECT_EQ(events_of_a_flight(speed, 0x1p-30, 0x1p-31), 0u);
    EXPECT_EQ(events_of_a_flight(speed, 0x1p-30, 0x1p-30 + 0x1p-51), 1u);
  }
}

// Through each other head on, at twice the speed, and past each other by one step.
TEST(ExtremeRelativeSpeed, HeadOnTheyPassThroughEachOtherAndAreReported) {
  for (const double speed : {1e3, 1e9, 1e15}) {
    for (const double summand : {0.0, 2.0, std::nextafter(2, 3)}) {
      extreme::Stage stage;
      const ObjectId a = stage.ball("a", {-speed, 0, 0}, 1);
      const ObjectId b = stage.ball("b", {speed, summand, 0}, 1);
      stage.step();
      stage.move(a, extreme::at({speed, 0, 0}));
      stage.move(b, extreme::at({-speed, summand, 0}));
      stage.step();
      EXPECT_EQ(extreme::count_of(stage.world.events(), EventKind::began), summand <= 2 ? 1u : 0u)
          << speed << " " << summand;
      EXPECT_EQ(extreme::count_of(stage.world.events(), EventKind::ended), summand <= 2 ? 1u : 0u);
    }
  }
}

TEST(ExtremeRelativeSpeed, StandingStillAtFullSpeedIsNoMotion) {
  extreme::Stage stage;
  const ObjectId a = stage.ball("a", {0, 0, 0}, 1);
  stage.ball("b", {std::nextafter(2, 3), 0, 0}, 1);
  stage.step();
  for (int i = 0; i < 10; ++i) {
    stage.move(a, extreme::at({0, 0, 0}));
    EXPECT_TRUE(stage.step().empty());
  }
}

}  // namespace
}  // namespace collided::engine::relative_speed_test
