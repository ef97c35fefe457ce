// Which object is nearest to another one or to a place, decided over whole motions.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/unit/world/standing_fixture.hpp"

namespace collided::engine {
namespace {

class NearestTest : public StandingTest {
 protected:
  static FenceDefinition question(const std::string& about, const std::string& only, const NearestRule& rule) {
    return {.name = "near", .shape = ball(0), .carrier = about, .only = only, .nearest = rule};
  }
  void ask(const std::string& about, const std::string& only, const NearestRule& rule) {
    EXPECT_EQ(refusal(question(about, only, rule)), "");
  }
};

// The walker passes two lamps that stand at 0 and 10: halfway the other one is nearer.
TEST_F(NearestTest, AnotherIsNearestFromHalfwayOn) {
  ask("walker", "lamp_*", {.within_m = 20});
  add("lamp_a", ball(0.5), {0, 2, 0}, kStill);
  add("lamp_b", ball(0.5), {10, 2, 0}, kStill);
  const ObjectId walker = add("walker", ball(0.5), {1, 0, 0});
  EXPECT_EQ(step_with(walker, {1, 0, 0}, 1), Lines{"began lamp_a near"});
  EXPECT_NEAR(-world_.fences()->events()[0].of.contact.depth_m, std::sqrt(5.0) - 1, 1e-12);
  ASSERT_EQ(step_with(walker, {9, 0, 0}, 3), (Lines{"ended lamp_a near goes on", "began lamp_b near"}));
  expect_at(0, 2);
  expect_at(1, 2);
  const OpenContact& now = world_.fences()->events()[1].of;
  EXPECT_NEAR(-now.contact.depth_m, std::sqrt(29.0) - 1, 1e-6);
  EXPECT_LT(now.contact.depth_error_m, 1e-12);
  EXPECT_EQ(world_.fences()->inside().size(), 1u);
}

TEST_F(NearestTest, APassageBetweenTwoPosesIsReportedWithTheReturn) {
  ask("post", "*", {.within_m = 20});
  add("post", ball(0.5), {0, 0, 0}, kStill);
  add("lamp", ball(0.5), {0, 4, 0}, kStill);
  const ObjectId drone = add("drone", ball(0.5), {-30, 2, 0});
  EXPECT_EQ(step_with(drone, {-30, 2, 0}, 1), Lines{"began lamp near"});
  ASSERT_EQ(step_with(drone, {30, 2, 0}, 2),
            (Lines{"ended lamp near goes on", "began drone near", "ended drone near goes on", "began lamp near"}));
  // Its surface is as near as the lamp's, 3 m away, where x * x + 4 = 16.
  expect_at(1, 1 + (30 - std::sqrt(12.0)) / 60);
  expect_at(3, 1 + (30 + std::sqrt(12.0)) / 60);
}

// A pose that comes late is dated right after what is decided, and a whole passage may lie in a nanosecond.
TEST_F(NearestTest, APassageInANanosecondEndsWithWhatIsNearestThen) {
  ask("post", "*", {.within_m = 20});
  add("post", ball(0.5), {0, 0, 0}, kStill);
  add("lamp", ball(0.5), {0, 4, 0}, kStill);
  const ObjectId drone = add("drone", ball(0.5), {-30, 2, 0});
  EXPECT_EQ(step_with(drone, {-30, 2, 0}, 1), Lines{"began lamp near"});
  EXPECT_EQ(step_with(drone, {30, 2, 0}, 1 + 1e-9),
            (Lines{"ended lamp near goes on", "began drone near", "ended drone near goes on", "began lamp near"}));
  EXPECT_EQ(step_with(drone, {30, 2, 0}, 2), Lines());
}

// The same where nothing is near at the end.
TEST_F(NearestTest, APassageInANanosecondMayEndWithNothingNear) {
  ask("", "drone", {.within_m = 5});
  const ObjectId drone = add("drone", ball(0.5), {-30, 2, 0});
  EXPECT_EQ(step_with(drone, {-30, 2, 0}, 1), Lines());
  EXPECT_EQ(step_with(drone, {30, 2, 0}, 1 + 1e-9), (Lines{"began drone near", "ended drone near"}));
}

TEST_F(NearestTest, BeyondItsReachNoObjectIsNearest) {
  ask("", "drone", {.within_m = 5, .hysteresis_m = 1});
  const ObjectId drone = add("drone", ball(0.5), {20.5, 0, 0});
  EXPECT_EQ(step_with(drone, {20.5, 0, 0}, 0), Lines());
  ASSERT_EQ(step_with(drone, {0.5, 0, 0}, 2), Lines{"began drone near"});
  expect_at(0, 1.5);
  ASSERT_EQ(step_with(drone, {20.5, 0, 0}, 4), Lines{"ended drone near"});
  expect_at(0, 2.6);
}

TEST_F(NearestTest, ATieChangesNothingAndHysteresisAsksForMore) {
  ask("", "ball_*", {.within_m = 50, .hysteresis_m = 1});
  start("ball_a", ball(0.5), {4, 0, 0});
  const ObjectId b = start("ball_b", ball(0.5), {0, 4, 0});
  EXPECT_EQ(step(), Lines{"began ball_a near"}) << "of two at the same distance the first by name";
  EXPECT_EQ(step_with(b, {0, 3.5, 0}, 1), Lines());
  ASSERT_EQ(step_with(b, {0, 2.5, 0}, 2), (Lines{"ended ball_a near goes on", "began ball_b near"}));
  expect_at(1, 1.5);
}

TEST_F(NearestTest, ARemovedObjectIsFollowedByTheNext) {
  ask("", "ball_*", {.within_m = 50});
  const ObjectId a = start("ball_a", ball(0.5), {4, 0, 0});
  const ObjectId b = start("ball_b", ball(0.5), {0, 6, 0});
  step();
  world_.remove(a, EndReason::removed);
  EXPECT_EQ(step(), (Lines{"ended ? near goes on removed", "began ball_b near"}));
  world_.remove(b, EndReason::removed);
  EXPECT_EQ(step(), Lines{"ended ? near removed"});
  add("ball_c", ball(0.5), {0, 9, 0}, kStill);
  EXPECT_EQ(step(), Lines{"began ball_c near"}) << "static objects count, too";
}

TEST_F(NearestTest, ATeleportedObjectJumps) {
  ask("", "ball_*", {.within_m = 50});
  start("ball_a", ball(0.5), {4, 0, 0});
  const ObjectId b = start("ball_b", ball(0.5), {0, 9, 0});
  step();
  ASSERT_EQ(step_with(b, {0, 2, 0}, 1, {.teleport = true}), (Lines{"ended ball_a near goes on", "began ball_b near"}));
  expect_at(1, 1);
}

// No event is reported for a time that one of the publishers has not reached.
TEST_F(NearestTest, ItWaitsForTheSlowerPublisher) {
  ask("", "ball_*", {.within_m = 50});
  const ObjectId a = start("ball_a", ball(0.5), {4, 0, 0});
  start("ball_b", ball(0.5), {0, 9, 0}, {.publisher = 2});
  step();
  EXPECT_EQ(step_with(a, {14, 0, 0}, 2), Lines());
  // a is 4 + 5 t away, b 9: after 1 s.
  world_.advance(2, time_ns(2));
  ASSERT_EQ(step(), (Lines{"ended ball_a near goes on", "began ball_b near"}));
  expect_at(1, 1);
}

TEST_F(NearestTest, TheObjectItIsAboutMayComeAndGo) {
  ask("walker", "ball", {.within_m = 50});
  add("ball", ball(0.5), {4, 0, 0}, kStill);
  EXPECT_EQ(step(), Lines());
  const ObjectId walker = add("walker", ball(0.5), {0, 0, 0});
  EXPECT_EQ(step(), Lines{"began ball near"});
  world_.remove(walker, EndReason::removed);
  EXPECT_EQ(step(), Lines{"ended ball near removed"});
  add("walker", ball(0.5), {9, 0, 0});
  EXPECT_EQ(step(), Lines{"began ball near"});
  EXPECT_TRUE(world_.remove_fence("near"));
  EXPECT_EQ(step(), Lines{"ended ball near fence_removed"});
  EXPECT_FALSE(world_.remove_fence("near"));
}

TEST_F(NearestTest, ALostObjectIsInDoubtUntilItIsBack) {
  ask("", "ball", {.within_m = 50});
  const ObjectId lost = add("ball", ball(0.5), {4, 0, 0}, {.lost = LostPolicy::freeze});
  EXPECT_EQ(step_with(lost, {4, 0, 0}, 0), Lines{"began ball near"});
  world_.set_stale(lost, true);
  world_.lose(1);
  EXPECT_EQ(step(), (Lines{"ended ball near goes on publisher_lost", "began ball near in doubt"}));
  world_.set_stale(lost, false);
  EXPECT_EQ(step_with(lost, {5, 0, 0}, 1), (Lines{"ended ball near goes on decided in doubt", "began ball near"}));
}

// Far movers cost no tests, and a world at rest costs none at all.
TEST_F(NearestTest, FarMoversCostNoTests) {
  ask("", "ball_*", {.within_m = 50});
  add("ball_a", ball(0.5), {4, 0, 0}, kStill);
  const ObjectId b = start("ball_b", ball(0.5), {0, 40, 0});
  step();
  step_with(b, {0, 30, 0}, 1);
  EXPECT_EQ(world_.fences()->cost().exact_tests, 0u);
  EXPECT_EQ(world_.fences()->cost().sweep_looks, 0u);
  step();
  EXPECT_EQ(world_.fences()->cost().exact_tests, 0u);
}

// The walker goes along the middle between two lamps: neither is surely nearer, and the search has a limit.
TEST_F(NearestTest, ATieAllTheWayHasALimitedCost) {
  ask("walker", "lamp_*", {.within_m = 50});
  add("lamp_a", ball(0.5), {0, 3, 0}, kStill);
  add("lamp_b", ball(0.5), {0, -3, 0}, kStill);
  const ObjectId walker = add("walker", ball(0.5), {-9, 0, 0});
  EXPECT_EQ(step_with(walker, {-9, 0, 0}, 0), Lines{"began lamp_a near"});
  EXPECT_EQ(step_with(walker, {9, 0, 0}, 1), Lines());
  EXPECT_LE(world_.fences()->cost().sweep_looks, 1'100u);
  EXPECT_EQ(world_.fences()->cost().sweeps_skipped, 1u);
  // From there on the other lamp is nearer. The interval left open before does not widen this bracket.
  ASSERT_EQ(step_with(walker, {9, -1, 0}, 2), (Lines{"ended lamp_a near goes on", "began lamp_b near"}));
  expect_at(1, 1);
}

TEST_F(NearestTest, AnInvalidQuestionIsRefused) {
  EXPECT_EQ(refusal(question("", "*", {.within_m = 0})),
            "nearest 'near': it looks 0 m far; a finite distance above 0 is needed. Nothing was added");
  EXPECT_NE(refusal(question("", "*", {.within_m = 1, .hysteresis_m = -1})).find("its hysteresis is -1"),
            std::string::npos);
  EXPECT_EQ(refusal(question("", "*", {.within_m = 1})), "");
  EXPECT_NE(refusal(question("", "*", {.within_m = 1})).find("the name is taken"), std::string::npos);
}

}  // namespace
}  // namespace collided::engine
