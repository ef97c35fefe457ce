// A body that trembles by one rounding at the contact boundary: hidden hysteresis swallows crossings, a tolerance
// invents them. Declared: touching is contact, each crossing is one event, and nothing is damped.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::chatter_test {
namespace {

/// The body goes up and down between two heights; every step must say exactly what it did.
void expect_one_event_a_crossing(extreme::Stage& stage, ObjectId body, const Vec3& down, const Vec3& up) {
  EXPECT_TRUE(stage.step().empty());
  std::uint64_t episode = 0;
  for (int i = 0; i < 1'000; ++i) {
    const bool falls = i % 2 == 0;
    stage.move(body, extreme::at(falls ? down : up));
    const std::vector<Event>& events = stage.step();
    ASSERT_EQ(events.size(), 1u) << i;
    ASSERT_EQ(events[0].kind, falls ? EventKind::began : EventKind::ended) << i;
    if (falls) {
      ASSERT_GT(events[0].of.episode, episode);
      episode = events[0].of.episode;
    } else {
      ASSERT_EQ(events[0].of.episode, episode) << "the end names its beginning";
      ASSERT_EQ(events[0].reason, EndReason::separated);
    }
  }
}

TEST(ExtremeChatter, ABallOnAFloorByOneRounding) {
  for (const double height : {1.0, 1e-9, 1e6}) {
    extreme::Stage stage;
    stage.add("floor", extreme::box_shape({height, height, height}), extreme::at({0, 0, -height}), false);
    const ObjectId ball = stage.ball("ball", {0, 0, std::nextafter(height, 2 * height)}, height);
    expect_one_event_a_crossing(stage, ball, {0, 0, height}, {0, 0, std::nextafter(height, 2 * height)});
  }
}

TEST(ExtremeChatter, ABoxOnATriangleByOneRounding) {
  extreme::Stage stage;
  TriangleMesh floor;
  floor.vertices = {{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}};
  floor.triangles = {{0, 1, 2}};
  stage.load("floor", floor);
  const ObjectId box = stage.block("box", {0, 0, std::nextafter(1, 2)}, {1, 1, 1});
  expect_one_event_a_crossing(stage, box, {0, 0, 1}, {0, 0, std::nextafter(1, 2)});
}

TEST(ExtremeChatter, SlidingAtOneRoundingAboveIsSilence) {
  extreme::Stage stage;
  stage.add("floor", extreme::box_shape({64, 64, 1}), extreme::at({0, 0, -1}), false);
  const ObjectId ball = stage.ball("ball", {-32, 0, std::nextafter(1, 2)}, 1);
  stage.step();
  for (int i = 1; i <= 64; ++i) {
    stage.move(ball, extreme::at({i - 32.0, 0, std::nextafter(1, 2)}));
    ASSERT_TRUE(stage.step().empty()) << i;
  }
}

TEST(ExtremeChatter, SlidingInTouchIsOneContact) {
  extreme::Stage stage;
  stage.add("floor", extreme::box_shape({64, 64, 1}), extreme::at({0, 0, -1}), false);
  const ObjectId ball = stage.ball("ball", {-32, 0, 1}, 1);
  EXPECT_EQ(stage.step().size(), 1u);
  for (int i = 1; i <= 64; ++i) {
    stage.move(ball, extreme::at({i - 32.0, 0, i % 2 == 0 ? 1.0 : std::nextafter(1, 0)}));
    ASSERT_TRUE(stage.step().empty()) << i;
  }
  EXPECT_EQ(stage.world.contacts().size(), 1u);
}

}  // namespace
}  // namespace collided::engine::chatter_test
