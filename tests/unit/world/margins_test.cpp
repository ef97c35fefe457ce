// Margins: who comes within distance bands of whom, decided over whole motions, with hysteresis and dwell.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "server/world/fences/fences.hpp"
#include "idl/topics.hpp"
#include "server/world/world.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

class MarginsTest : public testing::Test {
 protected:
  MarginsTest() { step(); }

  static Shape ball(double radius_m) {
    Shape shape;
    shape.primitives.emplace_back(Sphere{Vec3::Zero(), radius_m});
    return shape;
  }
  static Shape box(const Vec3& half_m) {
    Shape shape;
    shape.primitives.emplace_back(Box{.center = Vec3::Zero(), .half_m = half_m});
    return shape;
  }

  ObjectId add(const std::string& name, const Shape& shape, const Vec3& at, std::uint64_t publisher = 1,
               bool moving = true, LostPolicy lost = LostPolicy::remove, std::uint32_t layers = 1) {
    ObjectDefinition definition;
    definition.filter.layers = layers;
    definition.name = name;
    definition.shape = shape;
    definition.pose.position = at;
    definition.publisher = publisher;
    definition.moving = moving;
    definition.lost_policy = lost;
    definition.filter.group = 1;  // masks and groups do not matter to a margin
    world_.set_gap(publisher, wire_contract::kMostGapNs);
    return std::get<ObjectId>(world_.define(definition));
  }

  void margin(const std::string& around, const std::string& only, const MarginBands& rest,
              std::uint32_t mask = 0xffffffff) {
    FenceDefinition definition{.name = "close", .only = only, .mask = mask, .margin = rest};
    definition.margin->around = around;
    const auto added = world_.add_fence(definition);
    EXPECT_TRUE(std::holds_alternative<ObjectId>(added)) << std::get<Refusal>(added).reason;
  }
  std::string refusal(const FenceDefinition& definition) {
    const auto added = world_.add_fence(definition);
    return std::holds_alternative<Refusal>(added) ? std::get<Refusal>(added).reason : std::string();
  }

  /// The publisher says where the object is after so many seconds.
  void pose(ObjectId object, const Vec3& at, double after_s, std::uint64_t publisher = 1, bool teleport = false) {
    const ObjectId ids[] = {object};
    const Pose poses[] = {{.position = at}};
    bool moved[1];
    const std::int64_t time_ns = start_ns_ + std::llround(after_s * kSecond);
    world_.move(ids, poses, time_ns, teleport, moved);
    EXPECT_TRUE(moved[0]);
    world_.advance(publisher, time_ns);
  }

  void step() { EXPECT_TRUE(world_.step(now_ns_ += 1'000, 1, {})); }

  using Lines = std::vector<std::string>;

  /// What the last step told: "in a b 2", "out a b 2 removed".
  Lines told() const {
    static constexpr const char* kReasons[] = {"",           "separated",        "removed",         "publisher_lost",
                                               "teleported", "geometry_changed", "server_stopping", "server_restarted",
                                               "decided",    "crossed",          "fence_removed"};
    Lines lines;
    if (world_.fences() == nullptr) return lines;
    for (const Event& event : world_.fences()->events()) {
      const ObjectInfo* info = world_.info(event.of.a);
      std::string band(world_.fences()->name(event.of.b));
      std::vector<std::string> parts{""};
      for (const char c : band) {
        if (c == '\n') parts.emplace_back();
        else parts.back() += c;
      }
      lines.push_back(std::string(event.kind == EventKind::began ? "in " : "out ") +
                      (info != nullptr ? info->name : "?") + " " +
                      (parts.size() == 4 ? parts[1] + " " + parts[3] : "?"));
      const std::string reason = kReasons[static_cast<std::size_t>(event.reason)];
      if (!reason.empty() && reason != "separated") lines.back() += " " + reason;
      if (event.of.doubt != Doubt::none) lines.back() += " in doubt";
    }
    return lines;
  }

  /// Nanoseconds after the start between which the last step's event number i happened.
  std::pair<std::int64_t, std::int64_t> bracket(std::size_t i) const {
    const Event& event = world_.fences()->events().at(i);
    const auto after = [&](double ago_s) { return now_ns_ - start_ns_ - std::llround(ago_s * 1e9); };
    return {after(event.bracket_low_s), after(event.bracket_high_s)};
  }
  void expect_at(std::size_t i, double seconds) const {
    const auto [low_ns, high_ns] = bracket(i);
    EXPECT_LE(low_ns, seconds * 1e9);
    EXPECT_GE(high_ns, seconds * 1e9);
    EXPECT_LE(high_ns - low_ns, 10);
  }

  std::int64_t start_ns_ = 1'000 * kSecond;
  std::int64_t now_ns_ = start_ns_;
  World world_{WorldOptions{}};
};

// The mask is one of the moving objects of the second group. It also left out objects of the first group that came to bands
// about static objects of the second.
TEST_F(MarginsTest, AMaskLeavesOutObjectsOfTheSecondGroupAlone) {
  const auto put = [&](const char* name, double x, bool moving, std::uint32_t layers) {
    return add(name, ball(0.5), {x, 0, 0}, 1, moving, LostPolicy::remove, layers);
  };
  margin("drone*", "*", {.bands_m = {2, 0}}, 2);
  put("post", 0, false, 1);
  put("tree", 100, false, 2);
  const ObjectId drone = put("drone_b", 50, true, 1);
  const ObjectId zeppelin = put("zeppelin", -20, true, 1);
  const ObjectId apple = put("apple", -30, true, 2);
  const ObjectId other = put("drone_a", 70, true, 2);
  step();
  pose(drone, {2, 0, 0}, 1);
  step();
  EXPECT_EQ(told(), Lines{"in drone_b post 2"}) << "the drone is of the first group";
  pose(drone, {98, 0, 0}, 2, 1, true);
  step();
  EXPECT_EQ(told(), (Lines{"out drone_b post 2 teleported", "in drone_b tree 2"}));
  pose(drone, {50, 0, 0}, 3, 1, true);
  pose(zeppelin, {52, 0, 0}, 3, 1, true);
  step();
  EXPECT_EQ(told(), Lines{"out drone_b tree 2 teleported"}) << "no layer of the zeppelin is in the mask";
  pose(apple, {52, 0, 0}, 4, 1, true);
  step();
  EXPECT_EQ(told(), Lines{"in apple drone_b 2"});
  // Both are of both groups, but the mask takes drone_a alone for the second: the bands about drone_b report the pair.
  pose(apple, {-30, 0, 0}, 5, 1, true);
  pose(other, {48, 0, 0}, 5, 1, true);
  step();
  EXPECT_EQ(told(), (Lines{"out apple drone_b 2 teleported", "in drone_a drone_b 2"}));
}

TEST_F(MarginsTest, EveryBandIsToldWithItsTimeAndWhatComesNext) {
  margin("person", "drone*", {.bands_m = {5, 2, 0}});
  const ObjectId person = add("person", ball(0.5), {0, 0, 0});
  const ObjectId drone = add("drone_1", ball(0.5), {11, 0, 0});
  pose(person, {0, 0, 0}, 0);
  pose(drone, {11, 0, 0}, 0);
  step();
  EXPECT_EQ(told(), Lines());
  // The distance is 10 - 4 t: 5 after 1.25 s, 2 after 2 s; touching after 2.5 s.
  pose(drone, {3, 0, 0}, 2);
  step();
  ASSERT_EQ(told(), (Lines{"in drone_1 person 5", "in drone_1 person 2"}));
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
  pose(drone, {0.5, 0, 0}, 3);
  step();
  EXPECT_EQ(told(), Lines{"in drone_1 person 0"});
  expect_at(0, 2.8);
  pose(drone, {20.5, 0, 0}, 4);
  step();
  ASSERT_EQ(told(), (Lines{"out drone_1 person 5", "out drone_1 person 2", "out drone_1 person 0"}));
  expect_at(0, 3 + 5.5 / 20);
  expect_at(1, 3 + 2.5 / 20);
  expect_at(2, 3 + 0.5 / 20);
  EXPECT_TRUE(world_.fences()->inside().empty());
}

TEST_F(MarginsTest, WhatPassesBetweenTwoPosesIsNotMissed) {
  margin("post", "drone", {.bands_m = {1, 0}, .hysteresis_m = 0.25});
  add("post", ball(0.5), {0, 0, 0}, 0, false);
  const ObjectId drone = add("drone", ball(0.5), {-50, 1.5, 0});
  pose(drone, {-50, 1.5, 0}, 0);
  step();
  EXPECT_EQ(told(), Lines());
  pose(drone, {50, 1.5, 0}, 1);
  step();
  ASSERT_EQ(told(), (Lines{"in drone post 1", "out drone post 1"}));
  // In where the centres are 2 m apart, out beyond 2.25 m.
  expect_at(0, (50 - std::sqrt(4 - 2.25)) / 100);
  expect_at(1, (50 + std::sqrt(2.25 * 2.25 - 2.25)) / 100);
}

// Exactly at the band is in; the next double beyond it is not. For what only the given numbers decide.
// A monitor that reports each state tells of the two a hundred times here.
TEST_F(MarginsTest, WhatStaysNearIsToldOnce) {
  margin("person", "drone", {.bands_m = {5, 2}});
  const ObjectId person = add("person", ball(0.5), {0, 0, 0});
  const ObjectId drone = add("drone", ball(0.5), {11, 0, 0});
  pose(person, {0, 0, 0}, 0);
  pose(drone, {11, 0, 0}, 0);
  step();
  Lines all;
  for (int i = 1; i <= 100; ++i) {
    pose(drone, {4 + 0.01 * (i % 7), 0.01 * (i % 5), 0}, 0.1 * i);
    step();
    for (const std::string& line : told()) all.push_back(line);
  }
  EXPECT_EQ(all, Lines{"in drone person 5"});
}

// Leave for two to touch is none to come near unseen: whoever wants to know of touching ones names them.
TEST_F(MarginsTest, ARuleThatAllowsThemToTouchLeavesBandsAsTheyAre) {
  world_.set_pair_rules({{.a = "person", .b = "drone", .because = "they dance"}});
  margin("person", "drone", {.bands_m = {1, 0}});
  const ObjectId person = add("person", ball(0.5), {0, 0, 0});
  const ObjectId drone = add("drone", ball(0.5), {11, 0, 0});
  pose(person, {0, 0, 0}, 0);
  pose(drone, {11, 0, 0}, 0);
  step();
  pose(drone, {0.5, 0, 0}, 1);
  step();
  EXPECT_EQ(told(), (Lines{"in drone person 1", "in drone person 0"}));
  EXPECT_TRUE(world_.events().empty());
}

// The distance of an event is that of two balls at a time within its bracket: in rationals its bound holds both ends.
TEST_F(MarginsTest, TheDistanceThatIsToldHoldsTheTruth) {
  margin("person", "drone", {.bands_m = {2}});
  const ObjectId person = add("person", ball(0.5), {0, 0, 0});
  const ObjectId drone = add("drone", ball(0.5), {11, 0.7, 0});
  pose(person, {0, 0, 0}, 0);
  pose(drone, {11, 0.7, 0}, 0);
  step();
  pose(drone, {1, 0.7, 0}, 1);
  step();
  ASSERT_EQ(told(), Lines{"in drone person 2"});
  const Event& came = world_.fences()->events().at(0);
  const mpq_class told_m = -came.of.contact.depth_m;
  const mpq_class bound_m = came.of.contact.depth_error_m;
  const auto [low_ns, high_ns] = bracket(0);
  // The centres are 1 m more apart than the balls; y stays, x is 11 - 10 t.
  const auto square = [](std::int64_t ns) -> mpq_class {
    const mpq_class x = mpq_class(11) - mpq_class(10) * mpq_class(ns) / mpq_class(1'000'000'000);
    return x * x + mpq_class(0.7) * mpq_class(0.7);
  };
  const mpq_class most = told_m + bound_m + 1;
  const mpq_class least = told_m - bound_m + 1;
  EXPECT_LE(square(high_ns), most * most);
  EXPECT_GE(square(low_ns), least * least);
  EXPECT_LT(bound_m, 1e-6);
}

TEST_F(MarginsTest, ExactlyAtTheBandIsIn) {
  margin("a", "b*", {.bands_m = {0.7}});
  add("a", ball(0.1), {0, 0, 0}, 0, false);
  // 0.1 + 0.2 + 0.7 as doubles is a little more than 1, as real numbers of these doubles: b_near is at it, and b_at as
  // far as the nearest double can tell.
  const ObjectId near = add("b_near", ball(0.2), {9, 0, 0});
  const ObjectId far = add("b_far", ball(0.2), {0, 9, 0});
  pose(near, {9, 0, 0}, 0);
  pose(far, {0, 9, 0}, 0);
  step();
  pose(near, {1, 0, 0}, 1, 1, true);
  pose(far, {0, std::nextafter(1.0, 2.0), 0}, 1, 1, true);
  step();
  const mpq_class reach = mpq_class(0.1) + mpq_class(0.2) + mpq_class(0.7);
  Lines expected;
  if (reach >= 1) expected.push_back("in b_near a 0.7");
  if (reach >= mpq_class(std::nextafter(1.0, 2.0))) expected.push_back("in b_far a 0.7");
  EXPECT_EQ(told(), expected);
  EXPECT_EQ(world_.fences()->doubt_count(), 0u);
}

TEST_F(MarginsTest, ExactlyAtTheBandAndTheHysteresisStaysIn) {
  margin("a", "b", {.bands_m = {1}, .hysteresis_m = 0.5});
  add("a", box({1, 1, 1}), {0, 0, 0}, 0, false);
  const ObjectId b = add("b", box({1, 1, 1}), {9, 0, 0});
  pose(b, {9, 0, 0}, 0);
  step();
  pose(b, {3, 0, 0}, 1);
  step();
  EXPECT_EQ(told(), Lines{"in b a 1"}) << "exactly at the band";
  pose(b, {3.5, 0, 0}, 2);
  step();
  EXPECT_EQ(told(), Lines()) << "exactly at the band and the hysteresis";
  pose(b, {std::nextafter(3.5, 4.0), 0, 0}, 3);
  step();
  EXPECT_EQ(told(), Lines{"out b a 1"});
  pose(b, {3.25, 0, 0}, 4);
  step();
  EXPECT_EQ(told(), Lines()) << "between the two who was out stays out";
}

TEST_F(MarginsTest, ADwellIsWaitedForAndAFlickerIsNotTold) {
  margin("a", "b", {.bands_m = {1, 0}, .dwell_ns = kSecond / 2});
  add("a", ball(1), {0, 0, 0}, 0, false);
  const ObjectId b = add("b", ball(1), {5, 0, 0});
  pose(b, {5, 0, 0}, 0);
  step();
  // In at 2 s - and out again at 2.25 s.
  pose(b, {3, 0, 0}, 2);
  step();
  EXPECT_EQ(told(), Lines());
  EXPECT_TRUE(world_.fences()->waits_for_time());
  pose(b, {3, 0, 0}, 2.25);
  step();
  pose(b, {5, 0, 0}, 3);
  step();
  EXPECT_EQ(told(), Lines());
  EXPECT_FALSE(world_.fences()->waits_for_time());
  // In at 5 s, known to be in for the dwell at 5.5 s exactly.
  pose(b, {3, 0, 0}, 5);
  step();
  EXPECT_EQ(told(), Lines());
  pose(b, {2.5, 0, 0}, 5.5);
  step();
  ASSERT_EQ(told(), Lines{"in b a 1"});
  expect_at(0, 5);
  // Contact is told at once.
  pose(b, {1.5, 0, 0}, 5.75);
  step();
  EXPECT_EQ(told(), Lines{"in b a 0"});
  // Out for less than the dwell is not out.
  pose(b, {5, 0, 0}, 6);
  step();
  EXPECT_EQ(told(), Lines());
  pose(b, {1.5, 0, 0}, 6.25);
  step();
  EXPECT_EQ(told(), Lines());
  // Out of the contact after 6.36 s, of the band after 6.57 s.
  pose(b, {5, 0, 0}, 7);
  step();
  EXPECT_EQ(told(), Lines{"out b a 0"});
  pose(b, {6, 0, 0}, 8);
  step();
  EXPECT_EQ(told(), Lines{"out b a 1"});
}

// The publisher says nothing more of the object, only that time goes on.
TEST_F(MarginsTest, ADwellEndsThoughNothingMoves) {
  margin("a", "b", {.bands_m = {1}, .dwell_ns = kSecond / 2});
  add("a", ball(1), {0, 0, 0}, 0, false);
  const ObjectId b = add("b", ball(1), {5, 0, 0});
  pose(b, {5, 0, 0}, 0);
  step();
  pose(b, {2.5, 0, 0}, 1);
  step();
  EXPECT_EQ(told(), Lines());
  // In after 0.8 s.
  world_.advance(1, start_ns_ + 1'299'999'999);
  step();
  EXPECT_EQ(told(), Lines());
  world_.advance(1, start_ns_ + 1'300'000'010);
  step();
  EXPECT_EQ(told(), Lines{"in b a 1"});
}

TEST_F(MarginsTest, WhoIsPutElsewhereIsGoneAtOnce) {
  margin("a", "b", {.bands_m = {1}, .dwell_ns = kSecond / 2});
  add("a", ball(1), {0, 0, 0}, 0, false);
  const ObjectId b = add("b", ball(1), {5, 0, 0});
  pose(b, {5, 0, 0}, 0);
  step();
  pose(b, {2.5, 0, 0}, 1);
  step();
  pose(b, {9, 0, 0}, 1.1, 1, true);
  step();
  EXPECT_EQ(told(), Lines());
  EXPECT_FALSE(world_.fences()->waits_for_time()) << "it had come in, but not for long";
  pose(b, {2.5, 0, 0}, 2);
  step();
  pose(b, {2.5, 0.1, 0}, 3);
  step();
  EXPECT_EQ(told(), Lines{"in b a 1"});
  pose(b, {9, 0, 0}, 4, 1, true);
  step();
  EXPECT_EQ(told(), Lines{"out b a 1 teleported"});
}

TEST_F(MarginsTest, APairOfOneGroupIsToldOnce) {
  margin("drone*", "drone*", {.bands_m = {1}});
  const ObjectId a = add("drone_a", ball(0.5), {0, 0, 0});
  const ObjectId b = add("drone_b", ball(0.5), {9, 0, 0});
  pose(a, {0, 0, 0}, 0);
  pose(b, {9, 0, 0}, 0);
  step();
  pose(b, {1.5, 0, 0}, 1);
  step();
  EXPECT_EQ(told(), Lines{"in drone_b drone_a 1"});
  pose(a, {-9, 0, 0}, 2);
  step();
  EXPECT_EQ(told(), Lines{"out drone_b drone_a 1"});
}

// The band is about whichever of the two stands still, and both groups may.
TEST_F(MarginsTest, WhatStandsStillHasBandsWhicheverGroupItIsOf) {
  margin("drone", "post", {.bands_m = {1}});
  add("post", box({0.5, 0.5, 0.5}), {0, 0, 0}, 0, false);
  const ObjectId drone = add("drone", ball(0.5), {9, 0, 0});
  pose(drone, {9, 0, 0}, 0);
  step();
  pose(drone, {1.75, 0, 0}, 1);
  step();
  EXPECT_EQ(told(), Lines{"in drone post 1"});
}

TEST_F(MarginsTest, BandsComeAndGoWithTheObjectsThatHaveThem) {
  const ObjectId early = add("robot", ball(0.5), {0.5, 0, 0});
  const ObjectId person = add("person", ball(0.5), {0, 0, 0});
  margin("person*", "robot", {.bands_m = {1, 0}});
  step();
  EXPECT_EQ(told(), (Lines{"in robot person 1", "in robot person 0"})) << "who is near when it comes";
  add("person_2", ball(0.5), {0, 2, 0});
  step();
  // The centres are sqrt(4.25) = 2.06 m apart.
  EXPECT_EQ(told(), Lines());
  world_.remove(person, EndReason::removed);
  step();
  EXPECT_EQ(told(), (Lines{"out robot person 1 removed", "out robot person 0 removed"}));
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
  const ObjectId a = add("a", ball(0.5), {0, 0, 0});
  const ObjectId b = add("b", ball(0.5), {-9, 0, 0}, 2);
  pose(a, {0, 0, 0}, 0);
  pose(b, {-9, 0, 0}, 0, 2);
  step();
  EXPECT_EQ(told(), Lines());
  world_.advance(1, start_ns_ + 3 * kSecond);
  pose(b, {9, 0, 0}, 2, 2);
  step();
  EXPECT_EQ(told(), (Lines{"in b a 1", "out b a 1"}));
  const ObjectId third = add("a_third", ball(0.5), {9, 5, 0}, 3);
  pose(third, {9, 5, 0}, 2.5, 3);
  step();
  EXPECT_EQ(told(), Lines());
}

TEST_F(MarginsTest, RemovingTheMarginEndsItsStays) {
  margin("a", "b", {.bands_m = {1}});
  add("a", ball(1), {0, 0, 0}, 0, false);
  add("b", ball(1), {2.5, 0, 0});
  step();
  EXPECT_EQ(told(), Lines{"in b a 1"});
  EXPECT_TRUE(world_.remove_fence("close"));
  step();
  EXPECT_EQ(told(), Lines{"out b a 1 fence_removed"});
}

TEST_F(MarginsTest, AFrozenObjectIsInDoubtUntilItIsFoundAgain) {
  margin("a", "b", {.bands_m = {1}});
  add("a", ball(1), {0, 0, 0}, 0, false);
  const ObjectId b = add("b", ball(1), {2.5, 0, 0}, 1, true, LostPolicy::freeze);
  pose(b, {2.5, 0, 0}, 0);
  step();
  world_.set_stale(b, true);
  step();
  EXPECT_EQ(told(), (Lines{"out b a 1 publisher_lost", "in b a 1 in doubt"}));
  world_.set_stale(b, false);
  step();
  EXPECT_EQ(told(), (Lines{"out b a 1 decided in doubt", "in b a 1"}));
}

TEST_F(MarginsTest, ContactsAndFencesKnowNothingOfMargins) {
  margin("a", "b", {.bands_m = {1, 0}});
  add("a", ball(1), {0, 0, 0}, 0, false);
  add("b", ball(1), {1.5, 0, 0});
  step();
  EXPECT_TRUE(world_.events().empty()) << "the two are of one group";
  Shape shape = ball(1);
  EXPECT_NE(refusal({.name = "close", .shape = shape}).find("taken"), std::string::npos);
}

TEST_F(MarginsTest, WhatCannotBeIsRefusedWithTheReason) {
  const auto reason = [&](const MarginBands& bands) { return refusal({.name = "m", .only = "b", .margin = bands}); };
  EXPECT_NE(reason({.around = "a", .bands_m = {}}).find("no band"), std::string::npos);
  EXPECT_NE(reason({.around = "a", .bands_m = {1, 2}}).find("band 2 is 2 m, which is not less than 1 m"),
            std::string::npos);
  EXPECT_NE(reason({.around = "a", .bands_m = {-1}}).find("band 1 is -1 m"), std::string::npos);
  EXPECT_NE(reason({.around = "a", .bands_m = {1}, .hysteresis_m = -0.5}).find("hysteresis is -0.5 m"),
            std::string::npos);
  EXPECT_NE(reason({.around = "a", .bands_m = {1}, .dwell_ns = 3'601 * kSecond}).find("3601 s"), std::string::npos);
  EXPECT_NE(reason({.around = "a", .bands_m = {9, 8, 7, 6, 5, 4, 3, 2, 1}}).find("9 bands"), std::string::npos);
  EXPECT_TRUE(world_.fences()->margins().empty());
}

}  // namespace
}  // namespace collided::engine
