// Margins: which objects come within distance bands of which, decided over whole motions, with hysteresis and dwell.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/unit/world/standing_fixture.hpp"

namespace collided::engine {
namespace {

class MarginsTest : public StandingTest {
 protected:
  void margin(const std::string& around, const std::string& only, const MarginBands& rest,
              std::uint32_t mask = 0xffffffff) {
    FenceDefinition definition{.name = "close", .only = only, .mask = mask, .margin = rest};
    definition.margin->around = around;
    EXPECT_EQ(refusal(definition), "");
  }
};

// The mask selects objects of the second group, moving or static. It never leaves out objects of the first group.
TEST_F(MarginsTest, AMaskLeavesOutObjectsOfTheSecondGroupAlone) {
  const auto put = [&](const char* name, double x, bool moving, std::uint32_t layers) {
    return add(name, ball(0.5), {x, 0, 0}, {.layers = layers, .moving = moving});
  };
  margin("drone*", "*", {.bands_m = {2, 0}}, 2);
  put("post", 0, false, 1);
  put("tree", 100, false, 2);
  const ObjectId drone = put("drone_b", 50, true, 1);
  const ObjectId zeppelin = put("zeppelin", -20, true, 1);
  const ObjectId apple = put("apple", -30, true, 2);
  const ObjectId other = put("drone_a", 70, true, 2);
  step();
  EXPECT_EQ(step_with(drone, {2, 0, 0}, 1), Lines()) << "no layer of the post is in the mask";
  EXPECT_EQ(step_with(drone, {98, 0, 0}, 2, {.teleport = true}), Lines{"began drone_b tree 2"})
      << "the drone is of the first group";
  pose(drone, {50, 0, 0}, 3, {.teleport = true});
  EXPECT_EQ(step_with(zeppelin, {52, 0, 0}, 3, {.teleport = true}), Lines{"ended drone_b tree 2 teleported"})
      << "no layer of the zeppelin is in the mask";
  EXPECT_EQ(step_with(apple, {52, 0, 0}, 4, {.teleport = true}), Lines{"began apple drone_b 2"});
  // Both are of both groups, but the mask takes drone_a alone for the second: the bands about drone_b report the pair.
  pose(apple, {-30, 0, 0}, 5, {.teleport = true});
  EXPECT_EQ(step_with(other, {48, 0, 0}, 5, {.teleport = true}),
            (Lines{"ended apple drone_b 2 teleported", "began drone_a drone_b 2"}));
}

TEST_F(MarginsTest, EveryBandIsReportedWithItsTimeAndAPrediction) {
  margin("person", "drone*", {.bands_m = {5, 2, 0}});
  start("person", ball(0.5), {0, 0, 0});
  const ObjectId drone = add("drone_1", ball(0.5), {11, 0, 0});
  EXPECT_EQ(step_with(drone, {11, 0, 0}, 0), Lines());
  // The distance is 10 - 4 t: 5 after 1.25 s, 2 after 2 s; touching after 2.5 s.
  ASSERT_EQ(step_with(drone, {3, 0, 0}, 2), (Lines{"began drone_1 person 5", "began drone_1 person 2"}));
  expect_at(0, 1.25);
  expect_at(1, 2);
  const Event& came = world_.fences()->events().at(0);
  EXPECT_NEAR(-came.of.contact.depth_m, 5, 1e-6);
  EXPECT_NEAR(came.of.contact.point.x(), 5.5, 1e-6);
  EXPECT_NEAR(came.of.contact.normal.x(), -1, 1e-12);
  EXPECT_NEAR(came.relative_velocity.x(), 4, came.velocity_error + 1e-9);
  EXPECT_LT(came.velocity_error, 1e-6);
  // 5 m at 4 m/s.
  EXPECT_NEAR(came.of.surface.depth_m, 1.25, came.of.surface.depth_error_m + 1e-9);
  EXPECT_LT(came.of.surface.depth_error_m, 1e-6);
  EXPECT_EQ(step_with(drone, {0.5, 0, 0}, 3), Lines{"began drone_1 person 0"});
  expect_at(0, 2.8);
  ASSERT_EQ(step_with(drone, {20.5, 0, 0}, 4),
            (Lines{"ended drone_1 person 5", "ended drone_1 person 2", "ended drone_1 person 0"}));
  expect_at(0, 3 + 5.5 / 20);
  expect_at(1, 3 + 2.5 / 20);
  expect_at(2, 3 + 0.5 / 20);
  EXPECT_TRUE(world_.fences()->inside().empty());
}

TEST_F(MarginsTest, WhatPassesBetweenTwoPosesIsNotMissed) {
  margin("post", "drone", {.bands_m = {1, 0}, .hysteresis_m = 0.25});
  add("post", ball(0.5), {0, 0, 0}, kStill);
  const ObjectId drone = add("drone", ball(0.5), {-50, 1.5, 0});
  EXPECT_EQ(step_with(drone, {-50, 1.5, 0}, 0), Lines());
  ASSERT_EQ(step_with(drone, {50, 1.5, 0}, 1), (Lines{"began drone post 1", "ended drone post 1"}));
  // In where the centres are 2 m apart, out beyond 2.25 m.
  expect_at(0, (50 - std::sqrt(4 - 2.25)) / 100);
  expect_at(1, (50 + std::sqrt(2.25 * 2.25 - 2.25)) / 100);
}

// A monitor that reports states would report this pair a hundred times.
TEST_F(MarginsTest, AnObjectThatStaysNearIsReportedOnce) {
  margin("person", "drone", {.bands_m = {5, 2}});
  start("person", ball(0.5), {0, 0, 0});
  const ObjectId drone = start("drone", ball(0.5), {11, 0, 0});
  step();
  Lines all;
  for (int i = 1; i <= 100; ++i) {
    for (const std::string& line : step_with(drone, {4 + 0.01 * (i % 7), 0.01 * (i % 5), 0}, 0.1 * i))
      all.push_back(line);
  }
  EXPECT_EQ(all, Lines{"began drone person 5"});
}

// Bands ignore a rule that allows two objects to touch.
TEST_F(MarginsTest, ARuleThatAllowsContactLeavesBandsAsTheyAre) {
  world_.set_pair_rules({{.a = "person", .b = "drone", .because = "they dance"}});
  margin("person", "drone", {.bands_m = {1, 0}});
  start("person", ball(0.5), {0, 0, 0});
  const ObjectId drone = start("drone", ball(0.5), {11, 0, 0});
  step();
  EXPECT_EQ(step_with(drone, {0.5, 0, 0}, 1), (Lines{"began drone person 1", "began drone person 0"}));
  EXPECT_TRUE(world_.events().empty());
}

// The distance of an event is that of two balls at a time within its bracket: in rationals its bound holds both ends.
TEST_F(MarginsTest, TheReportedDistanceHoldsTheTruth) {
  margin("person", "drone", {.bands_m = {2}});
  start("person", ball(0.5), {0, 0, 0});
  const ObjectId drone = start("drone", ball(0.5), {11, 0.7, 0});
  step();
  ASSERT_EQ(step_with(drone, {1, 0.7, 0}, 1), Lines{"began drone person 2"});
  const Event& came = world_.fences()->events().at(0);
  const mpq_class reported_m = -came.of.contact.depth_m;
  const mpq_class bound_m = came.of.contact.depth_error_m;
  const auto [low_ns, high_ns] = bracket(0);
  // The centres are 1 m more apart than the balls; y stays, x is 11 - 10 t.
  const auto square = [](std::int64_t ns) -> mpq_class {
    const mpq_class x = mpq_class(11) - mpq_class(10) * mpq_class(ns) / mpq_class(1'000'000'000);
    return x * x + mpq_class(0.7) * mpq_class(0.7);
  };
  const mpq_class most = reported_m + bound_m + 1;
  const mpq_class least = reported_m - bound_m + 1;
  EXPECT_LE(square(high_ns), most * most);
  EXPECT_GE(square(low_ns), least * least);
  EXPECT_LT(bound_m, 1e-6);
}

// Exactly at the band is in, and the next double beyond it is not. The numbers as given decide.
TEST_F(MarginsTest, ExactlyAtTheBandIsIn) {
  margin("a", "b*", {.bands_m = {0.7}});
  add("a", ball(0.1), {0, 0, 0}, kStill);
  // The sum of the doubles 0.1, 0.2 and 0.7 as real numbers decides: b_near is at 1, b_far at the next double.
  const ObjectId near = start("b_near", ball(0.2), {9, 0, 0});
  const ObjectId far = start("b_far", ball(0.2), {0, 9, 0});
  step();
  pose(near, {1, 0, 0}, 1, {.teleport = true});
  const mpq_class reach = mpq_class(0.1) + mpq_class(0.2) + mpq_class(0.7);
  Lines expected;
  if (reach >= 1) expected.push_back("began b_near a 0.7");
  if (reach >= mpq_class(std::nextafter(1.0, 2.0))) expected.push_back("began b_far a 0.7");
  EXPECT_EQ(step_with(far, {0, std::nextafter(1.0, 2.0), 0}, 1, {.teleport = true}), expected);
  EXPECT_EQ(world_.fences()->doubt_count(), 0u);
}

TEST_F(MarginsTest, ExactlyAtTheBandAndTheHysteresisStaysIn) {
  margin("a", "b", {.bands_m = {1}, .hysteresis_m = 0.5});
  add("a", box({1, 1, 1}), {0, 0, 0}, kStill);
  const ObjectId b = start("b", box({1, 1, 1}), {9, 0, 0});
  step();
  EXPECT_EQ(step_with(b, {3, 0, 0}, 1), Lines{"began b a 1"}) << "exactly at the band";
  EXPECT_EQ(step_with(b, {3.5, 0, 0}, 2), Lines()) << "exactly at the band and the hysteresis";
  EXPECT_EQ(step_with(b, {std::nextafter(3.5, 4.0), 0, 0}, 3), Lines{"ended b a 1"});
  EXPECT_EQ(step_with(b, {3.25, 0, 0}, 4), Lines()) << "between the two distances an object outside stays outside";
}

TEST_F(MarginsTest, ADwellIsWaitedForAndAFlickerIsNotReported) {
  margin("a", "b", {.bands_m = {1, 0}, .dwell_ns = kSecond_ns / 2});
  add("a", ball(1), {0, 0, 0}, kStill);
  const ObjectId b = start("b", ball(1), {5, 0, 0});
  step();
  // In at 2 s, and out again after 2.25 s.
  EXPECT_EQ(step_with(b, {3, 0, 0}, 2), Lines());
  EXPECT_TRUE(world_.fences()->waits_for_time());
  step_with(b, {3, 0, 0}, 2.25);
  EXPECT_EQ(step_with(b, {5, 0, 0}, 3), Lines());
  EXPECT_FALSE(world_.fences()->waits_for_time());
  // In at 5 s, known to be in for the dwell at 5.5 s exactly.
  EXPECT_EQ(step_with(b, {3, 0, 0}, 5), Lines());
  ASSERT_EQ(step_with(b, {2.5, 0, 0}, 5.5), Lines{"began b a 1"});
  expect_at(0, 5);
  // Contact is reported at once.
  EXPECT_EQ(step_with(b, {1.5, 0, 0}, 5.75), Lines{"began b a 0"});
  // Out for less than the dwell is not out.
  EXPECT_EQ(step_with(b, {5, 0, 0}, 6), Lines());
  EXPECT_EQ(step_with(b, {1.5, 0, 0}, 6.25), Lines());
  // Out of the contact after 6.36 s, of the band after 6.57 s.
  EXPECT_EQ(step_with(b, {5, 0, 0}, 7), Lines{"ended b a 0"});
  EXPECT_EQ(step_with(b, {6, 0, 0}, 8), Lines{"ended b a 1"});
}

// The publisher sends no more poses of the object, only that time goes on.
TEST_F(MarginsTest, ADwellEndsThoughNothingMoves) {
  margin("a", "b", {.bands_m = {1}, .dwell_ns = kSecond_ns / 2});
  add("a", ball(1), {0, 0, 0}, kStill);
  const ObjectId b = start("b", ball(1), {5, 0, 0});
  step();
  EXPECT_EQ(step_with(b, {2.5, 0, 0}, 1), Lines());
  // In after 0.8 s.
  world_.advance(1, time_ns(1.299'999'999));
  EXPECT_EQ(step(), Lines());
  world_.advance(1, time_ns(1.300'000'010));
  EXPECT_EQ(step(), Lines{"began b a 1"});
}

TEST_F(MarginsTest, ATeleportedObjectLeavesAtOnce) {
  margin("a", "b", {.bands_m = {1}, .dwell_ns = kSecond_ns / 2});
  add("a", ball(1), {0, 0, 0}, kStill);
  const ObjectId b = start("b", ball(1), {5, 0, 0});
  step();
  step_with(b, {2.5, 0, 0}, 1);
  EXPECT_EQ(step_with(b, {9, 0, 0}, 1.1, {.teleport = true}), Lines());
  EXPECT_FALSE(world_.fences()->waits_for_time()) << "it had come in, but not for long";
  step_with(b, {2.5, 0, 0}, 2);
  EXPECT_EQ(step_with(b, {2.5, 0.1, 0}, 3), Lines{"began b a 1"});
  EXPECT_EQ(step_with(b, {9, 0, 0}, 4, {.teleport = true}), Lines{"ended b a 1 teleported"});
}

TEST_F(MarginsTest, APairOfOneGroupIsReportedOnce) {
  margin("drone*", "drone*", {.bands_m = {1}});
  const ObjectId a = start("drone_a", ball(0.5), {0, 0, 0});
  const ObjectId b = start("drone_b", ball(0.5), {9, 0, 0});
  step();
  EXPECT_EQ(step_with(b, {1.5, 0, 0}, 1), Lines{"began drone_b drone_a 1"});
  EXPECT_EQ(step_with(a, {-9, 0, 0}, 2), Lines{"ended drone_b drone_a 1"});
}

// The static object has the band, whichever of the two groups it is of.
TEST_F(MarginsTest, AStaticObjectHasBandsWhicheverGroupItIsOf) {
  margin("drone", "post", {.bands_m = {1}});
  add("post", box({0.5, 0.5, 0.5}), {0, 0, 0}, kStill);
  const ObjectId drone = start("drone", ball(0.5), {9, 0, 0});
  step();
  EXPECT_EQ(step_with(drone, {1.75, 0, 0}, 1), Lines{"began drone post 1"});
}

TEST_F(MarginsTest, BandsComeAndGoWithTheObjectsThatHaveThem) {
  const ObjectId early = add("robot", ball(0.5), {0.5, 0, 0});
  const ObjectId person = add("person", ball(0.5), {0, 0, 0});
  margin("person*", "robot", {.bands_m = {1, 0}});
  EXPECT_EQ(step(), (Lines{"began robot person 1", "began robot person 0"}))
      << "an object that is near when the margin comes";
  add("person_2", ball(0.5), {0, 2, 0});
  EXPECT_EQ(step(), Lines()) << "the centres are sqrt(4.25) = 2.06 m apart";
  world_.remove(person, EndReason::removed);
  EXPECT_EQ(step(), (Lines{"ended robot person 1 removed", "ended robot person 0 removed"}));
  world_.remove(early, EndReason::publisher_lost);
  step();
  EXPECT_TRUE(world_.fences()->inside().empty());
  EXPECT_TRUE(world_.remove_fence("close"));
  EXPECT_FALSE(world_.remove_fence("close"));
  step();
  EXPECT_EQ(world_.fences()->table().count(), 0u);
}

// Both come and fly past each other before the first step that sees them.
TEST_F(MarginsTest, WhatPassesBeforeTheFirstStepIsNotMissed) {
  margin("a", "b", {.bands_m = {1}});
  step();
  start("a", ball(0.5), {0, 0, 0});
  const ObjectId b = add("b", ball(0.5), {-9, 0, 0}, {.publisher = 2});
  EXPECT_EQ(step_with(b, {-9, 0, 0}, 0, {.publisher = 2}), Lines());
  world_.advance(1, time_ns(3));
  EXPECT_EQ(step_with(b, {9, 0, 0}, 2, {.publisher = 2}), (Lines{"began b a 1", "ended b a 1"}));
  const ObjectId third = add("a_third", ball(0.5), {9, 5, 0}, {.publisher = 3});
  EXPECT_EQ(step_with(third, {9, 5, 0}, 2.5, {.publisher = 3}), Lines());
}

TEST_F(MarginsTest, RemovingTheMarginEndsItsStays) {
  margin("a", "b", {.bands_m = {1}});
  add("a", ball(1), {0, 0, 0}, kStill);
  add("b", ball(1), {2.5, 0, 0});
  EXPECT_EQ(step(), Lines{"began b a 1"});
  EXPECT_TRUE(world_.remove_fence("close"));
  EXPECT_EQ(step(), Lines{"ended b a 1 fence_removed"});
}

TEST_F(MarginsTest, AFrozenObjectIsInDoubtUntilItIsFoundAgain) {
  margin("a", "b", {.bands_m = {1}});
  add("a", ball(1), {0, 0, 0}, kStill);
  const ObjectId b = start("b", ball(1), {2.5, 0, 0}, {.lost = LostPolicy::freeze});
  step();
  world_.set_stale(b, true);
  EXPECT_EQ(step(), (Lines{"ended b a 1 publisher_lost", "began b a 1 in doubt"}));
  world_.set_stale(b, false);
  EXPECT_EQ(step(), (Lines{"ended b a 1 decided in doubt", "began b a 1"}));
}

// A dwell kept the turns of a lost object waiting, and then ended a stay that had never been reported.
TEST_F(MarginsTest, AFrozenObjectIsInDoubtAtOnceWhateverTheDwell) {
  margin("a", "b", {.bands_m = {1}, .dwell_ns = 100'000'000});
  const ObjectId a = start("a", ball(1), {0, 0, 0}, {.publisher = 2});
  const ObjectId b = start("b", ball(1), {10, 0, 0}, {.lost = LostPolicy::freeze});
  step();
  world_.lose(1);
  world_.set_stale(b, true);
  step();
  const auto move_a = [&](double x_m, double after_s) {
    pose(a, {x_m, 0, 0}, after_s, {.publisher = 2});
    return step_at(after_s);
  };
  EXPECT_EQ(move_a(7.5, 0.5), Lines{"began b a 1 in doubt"});
  EXPECT_EQ(move_a(0, 1), Lines{"ended b a 1 decided in doubt"});
  for (const double after_s : {1.5, 2.0, 2.5}) EXPECT_EQ(move_a(-after_s, after_s), Lines{});
}

// The loss of the object that has the bands ends what was pending of them.
TEST_F(MarginsTest, WhatWasPendingIsDroppedWithALostObjectThatHasTheBands) {
  margin("a", "b", {.bands_m = {1}, .dwell_ns = 2 * kSecond_ns});
  const ObjectId a = start("a", ball(1), {0, 0, 0}, {.publisher = 2, .lost = LostPolicy::freeze});
  const ObjectId b = add("b", ball(1), {10, 0, 0});
  const auto move_b = [&](double x_m, double after_s) {
    pose(b, {x_m, 0, 0}, after_s);
    return step_at(after_s);
  };
  EXPECT_EQ(move_b(10, 0), Lines{});
  pose(a, {0, 0, 0}, 0.5, {.publisher = 2});
  EXPECT_EQ(move_b(2.5, 0.5), Lines{});
  world_.lose(2);
  world_.set_stale(a, true);
  EXPECT_EQ(move_b(2.4, 1), Lines{"began b a 1 in doubt"});
  EXPECT_EQ(move_b(2.3, 4), Lines{});
}

TEST_F(MarginsTest, ContactsAndFencesKnowNothingOfMargins) {
  margin("a", "b", {.bands_m = {1, 0}});
  add("a", ball(1), {0, 0, 0}, kStill);
  add("b", ball(1), {1.5, 0, 0});
  step();
  EXPECT_TRUE(world_.events().empty()) << "the two are of one group";
  EXPECT_NE(refusal({.name = "close", .shape = ball(1)}).find("taken"), std::string::npos);
}

TEST_F(MarginsTest, AnInvalidMarginIsRefusedWithTheReason) {
  const auto reason = [&](const MarginBands& bands) { return refusal({.name = "m", .only = "b", .margin = bands}); };
  EXPECT_NE(reason({.around = "a", .bands_m = {}}).find("no band"), std::string::npos);
  EXPECT_NE(reason({.around = "a", .bands_m = {1, 2}}).find("band 2 is 2 m, which is not less than 1 m"),
            std::string::npos);
  EXPECT_NE(reason({.around = "a", .bands_m = {-1}}).find("band 1 is -1 m"), std::string::npos);
  EXPECT_NE(reason({.around = "a", .bands_m = {1}, .hysteresis_m = -0.5}).find("hysteresis is -0.5 m"),
            std::string::npos);
  EXPECT_NE(reason({.around = "a", .bands_m = {1}, .dwell_ns = 3'601 * kSecond_ns}).find("3601 s"), std::string::npos);
  EXPECT_NE(reason({.around = "a", .bands_m = {9, 8, 7, 6, 5, 4, 3, 2, 1}}).find("9 bands"), std::string::npos);
  EXPECT_TRUE(world_.fences()->margins().empty());
}

}  // namespace
}  // namespace collided::engine
