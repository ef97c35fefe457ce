// How events of standing questions are numbered: a crossing and a change of the nearest object are one event each, though
// the ledger has an end and a beginning of both.
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/world/standing_fixture.hpp"

namespace collided::engine {
namespace {

class StandingNumbers : public StandingTest {
 protected:
  void add_region(const std::string& name, double x, std::uint8_t detects) {
    EXPECT_EQ(refusal({.name = name, .shape = box({0.005, 2.5, 1.5}, {x, 2.5, 1.5}), .detects = detects}), "");
  }
  void add_band(const std::string& around) {
    FenceDefinition margin{.name = "close", .only = "drone", .margin = MarginBands{.bands_m = {1, 0}}};
    margin.margin->around = around;
    EXPECT_EQ(refusal(margin), "");
  }
  void ask_nearest(const std::string& about, const std::string& only) {
    EXPECT_EQ(
        refusal(
            {.name = "near", .shape = ball(0), .carrier = about, .only = only, .nearest = NearestRule{.within_m = 20}}),
        "");
  }
  /// A drone that flies past x = 0 with the next pose.
  void start_drone() { drone_ = start("drone", ball(0.1), {-2, 1, 1}); }
  void fly() { step_with(drone_, {2, 1, 1}, 0.1); }

  /// The last step's events with their numbers: "1 began 1" is event 1, of episode 1; with a "+" the next one is a part of
  /// the same.
  Lines numbers() const {
    Lines lines;
    for (const Event& event : world_.fences()->events())
      lines.push_back(std::to_string(event.sequence) + (event.kind == EventKind::began ? " began " : " ended ") +
                      std::to_string(event.of.episode) + (event.joins_next ? " +" : ""));
    return lines;
  }
  std::uint64_t last_number() const { return world_.fences()->last_sequence(); }

  ObjectId drone_ = 0;
};

TEST_F(StandingNumbers, ACrossingIsOneEventOfARegionThatDetectsIt) {
  add_region("wire", 0, codes::kDetectCross);
  start_drone();
  step();
  fly();
  EXPECT_EQ(numbers(), (Lines{"1 began 1 +", "1 ended 1"}));
  EXPECT_EQ(last_number(), 1U);
  step_with(drone_, {0, 1, 1}, 0.2);
  EXPECT_EQ(numbers(), Lines{"2 began 2"});
  step_with(drone_, {2, 1, 1}, 0.3);
  EXPECT_EQ(numbers(), Lines{"3 ended 2"});
}

TEST_F(StandingNumbers, ACrossingIsTwoEventsOfARegionThatDoesNotDetectIt) {
  add_region("wire", 0, codes::kDetectEnter | codes::kDetectExit);
  start_drone();
  step();
  fly();
  EXPECT_EQ(numbers(), (Lines{"1 began 1", "2 ended 1"}));
  EXPECT_EQ(last_number(), 2U);
}

TEST_F(StandingNumbers, ABandThatIsCrossedHasTwoEvents) {
  add("post", ball(0.5), {0, 2, 1}, kStill);
  add_band("post");
  start_drone();
  step();
  fly();
  EXPECT_EQ(numbers(), (Lines{"1 began 1", "2 ended 1"}));
}

TEST_F(StandingNumbers, AChangeOfTheNearestIsOneEvent) {
  ask_nearest("walker", "lamp_*");
  add("lamp_a", ball(0.5), {0, 2, 0}, kStill);
  const ObjectId b = start("lamp_b", ball(0.5), {10, 2, 0});
  const ObjectId walker = start("walker", ball(0.5), {1, 0, 0});
  step();
  EXPECT_EQ(numbers(), Lines{"1 began 1"});
  pose(b, {10, 2, 0}, 1);
  step_with(walker, {9, 0, 0}, 1);
  EXPECT_EQ(numbers(), (Lines{"2 ended 1 +", "2 began 2"}));
  world_.remove(b, EndReason::removed);
  step();
  EXPECT_EQ(numbers(), (Lines{"3 ended 2 +", "3 began 3"}));
  EXPECT_TRUE(world_.remove_fence("near"));
  step();
  EXPECT_EQ(numbers(), Lines{"4 ended 3"}) << "no object takes its place";
}

// The drone crosses two regions and a band, and is nearer to the origin than the post for a while.
TEST_F(StandingNumbers, AStepHasNoGap) {
  add("post", ball(0.5), {0, 2, 1}, kStill);
  add_region("wire", 0, kDetectAll);
  add_region("quiet", 1, codes::kDetectEnter);
  add_band("post");
  ask_nearest("", "*");
  start_drone();
  step();
  EXPECT_EQ(numbers(), Lines{"1 began 1"});
  fly();
  ASSERT_EQ(numbers().size(), 10U);
  std::uint64_t last = 1;
  bool is_joined = false;
  for (const Event& event : world_.fences()->events()) {
    EXPECT_EQ(event.sequence, is_joined ? last : last + 1);
    EXPECT_LE(event.of.episode, event.sequence);
    EXPECT_TRUE(event.kind == EventKind::ended || event.of.episode == event.sequence);
    last = event.sequence;
    is_joined = event.joins_next;
  }
  EXPECT_FALSE(is_joined);
  EXPECT_EQ(last, 8U) << "of the wire one, of the other region and of the band two, of the nearest two";
  EXPECT_EQ(last_number(), last);
}

}  // namespace
}  // namespace collided::engine
