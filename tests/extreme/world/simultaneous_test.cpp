// A thousand contacts at one instant: an order by time, by memory address or by thread is a different one each run.
#include <gtest/gtest.h>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::simultaneous_test {
namespace {

TEST(ExtremeSimultaneous, AThousandPairsBeginInOrderOfTheirIds) {
  extreme::Stage stage;
  std::vector<ObjectId> left, right;
  for (int i = 0; i < 1'000; ++i) left.push_back(stage.ball("left" + std::to_string(i), {-3, 4.0 * i, 0}, 1));
  for (int i = 999; i >= 0; --i) right.push_back(stage.ball("right" + std::to_string(i), {3, 4.0 * i, 0}, 1));
  stage.step();
  for (int i = 999; i >= 0; --i) {
    stage.move(left[static_cast<std::size_t>(i)], extreme::at({-1, 4.0 * i, 0}));
    stage.move(right[static_cast<std::size_t>(999 - i)], extreme::at({1, 4.0 * i, 0}));
  }
  const std::vector<Event>& events = stage.step();
  ASSERT_EQ(events.size(), 1'000u);
  for (std::size_t i = 0; i < 1'000; ++i) {
    ASSERT_EQ(events[i].of.a, left[i]);
    ASSERT_EQ(events[i].of.b, right[999 - i]);
    ASSERT_EQ(events[i].of.contact.depth_m, 0) << "they touch at the end of the step";
    ASSERT_LE(events[i].bracket_high_s, 1e-9);
    ASSERT_EQ(events[i].sequence, events[0].sequence + i);
  }
}

// One ball among a hundred at once: a pair each, all at the same time.
TEST(ExtremeSimultaneous, AllAtOnceIntoOneBall) {
  extreme::Stage stage;
  const ObjectId target = stage.ball("target", {0, 0, 0}, 3);
  std::vector<ObjectId> around;
  // Pythagorean directions: each centre at distance 5 exactly.
  for (const Vec3& place :
       {Vec3(3, 4, 0), Vec3(-3, 4, 0), Vec3(3, -4, 0), Vec3(0, 3, 4), Vec3(0, -3, -4), Vec3(5, 0, 0), Vec3(0, 0, -5)}) {
    around.push_back(stage.ball("ball" + std::to_string(around.size()), 3 * place, 2));
  }
  stage.step();
  const Vec3 places[] = {{3, 4, 0}, {-3, 4, 0}, {3, -4, 0}, {0, 3, 4}, {0, -3, -4}, {5, 0, 0}, {0, 0, -5}};
  for (std::size_t i = 0; i < around.size(); ++i) stage.move(around[i], extreme::at(places[i]));
  stage.step();
  std::size_t with_target = 0;
  for (const Event& event : stage.world.events()) {
    ASSERT_EQ(event.kind, EventKind::began);
    if (event.of.a != target) continue;
    ++with_target;
    EXPECT_EQ(event.of.contact.depth_m, 0);
  }
  EXPECT_EQ(with_target, 7u);
}

}  // namespace
}  // namespace collided::engine::simultaneous_test
