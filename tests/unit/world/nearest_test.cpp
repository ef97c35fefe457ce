// Questions that stay for the nearest object: who it is, decided over whole motions.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "server/world/fences/fences.hpp"
#include "idl/topics.hpp"
#include "server/world/world.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

class NearestTest : public testing::Test {
 protected:
  NearestTest() { step(); }

  ObjectId add(const std::string& name, const Vec3& at, std::uint64_t publisher = 1, bool moving = true,
               LostPolicy lost = LostPolicy::remove) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape.primitives.emplace_back(Sphere{Vec3::Zero(), 0.5});
    definition.pose.position = at;
    definition.publisher = publisher;
    definition.moving = moving;
    definition.lost_policy = lost;
    definition.filter.group = 1;  // groups do not matter to the question
    world_.set_gap(publisher, wire_contract::kMostGapNs);
    return std::get<ObjectId>(world_.define(definition));
  }

  static FenceDefinition question(const std::string& about, const std::string& only, const NearestRule& rule) {
    FenceDefinition definition{.name = "near", .carrier = about, .only = only, .nearest = rule};
    definition.shape.primitives.emplace_back(Sphere{Vec3::Zero(), 0});
    return definition;
  }
  void ask(const std::string& about, const std::string& only, const NearestRule& rule) {
    const auto added = world_.add_fence(question(about, only, rule));
    EXPECT_TRUE(std::holds_alternative<ObjectId>(added)) << std::get<Refusal>(added).reason;
  }
  std::string refusal(const FenceDefinition& definition) {
    const auto added = world_.add_fence(definition);
    return std::holds_alternative<Refusal>(added) ? std::get<Refusal>(added).reason : std::string();
  }

  void pose(ObjectId object, const Vec3& at, double after_s, std::uint64_t publisher = 1, bool teleport = false) {
    const ObjectId ids[] = {object};
    const Pose poses[] = {{.position = at}};
    bool moved[1];
    const std::int64_t time_ns = start_ns_ + std::llround(after_s * kSecond_ns);
    world_.move(ids, poses, time_ns, teleport, moved);
    EXPECT_TRUE(moved[0]);
    world_.advance(publisher, time_ns);
  }
  void pose(const std::vector<std::pair<ObjectId, Vec3>>& all, double after_s) {
    std::vector<ObjectId> ids;
    std::vector<Pose> poses;
    for (const auto& [id, at] : all) {
      ids.push_back(id);
      poses.push_back({.position = at});
    }
    bool moved[8];
    world_.move(ids, poses, start_ns_ + std::llround(after_s * kSecond_ns), false, {moved, ids.size()});
    world_.advance(1, start_ns_ + std::llround(after_s * kSecond_ns));
  }

  void step() { EXPECT_TRUE(world_.step(now_ns_ += 1'000, 1, {})); }

  using Lines = std::vector<std::string>;

  /// What the last step told: "began a", "ended a goes on", "ended a removed".
  Lines told() const {
    static constexpr const char* kReasons[] = {"",
                                               "",
                                               "removed",
                                               "publisher_lost",
                                               "teleported",
                                               "geometry_changed",
                                               "server_stopping",
                                               "server_restarted",
                                               "decided",
                                               "crossed",
                                               "fence_removed"};
    Lines lines;
    if (world_.fences() == nullptr) return lines;
    for (const Event& event : world_.fences()->events()) {
      const ObjectInfo* info = world_.info(event.of.a);
      lines.push_back(std::string(event.kind == EventKind::began ? "began " : "ended ") +
                      (info != nullptr ? info->name : "?"));
      if (event.of.b_triangle == kNearestGoesOn) lines.back() += " goes on";
      const std::string reason = kReasons[static_cast<std::size_t>(event.reason)];
      if (!reason.empty()) lines.back() += " " + reason;
      if (event.of.doubt != Doubt::none) lines.back() += " in doubt";
    }
    return lines;
  }
  void expect_at(std::size_t i, double seconds) const {
    const Event& event = world_.fences()->events().at(i);
    const auto after = [&](double ago_s) { return now_ns_ - start_ns_ - std::llround(ago_s * 1e9); };
    EXPECT_LE(after(event.bracket_low_s), seconds * 1e9);
    EXPECT_GE(after(event.bracket_high_s), seconds * 1e9);
    EXPECT_LE(after(event.bracket_high_s) - after(event.bracket_low_s), 20);
  }

  std::int64_t start_ns_ = 1'000 * kSecond_ns;
  std::int64_t now_ns_ = start_ns_;
  World world_{WorldOptions{}};
};

// The walker passes two lamps that stand at 0 and 10: halfway the other one is nearer.
TEST_F(NearestTest, AnotherIsNearestFromHalfwayOn) {
  ask("walker", "lamp_*", {.within_m = 20});
  add("lamp_a", {0, 2, 0}, 0, false);
  add("lamp_b", {10, 2, 0}, 0, false);
  const ObjectId walker = add("walker", {1, 0, 0});
  pose(walker, {1, 0, 0}, 1);
  step();
  EXPECT_EQ(told(), Lines{"began lamp_a"});
  EXPECT_NEAR(-world_.fences()->events()[0].of.contact.depth_m, std::sqrt(5.0) - 1, 1e-12);
  pose(walker, {9, 0, 0}, 3);
  step();
  ASSERT_EQ(told(), (Lines{"ended lamp_a goes on", "began lamp_b"}));
  expect_at(0, 2);
  expect_at(1, 2);
  const OpenContact& now = world_.fences()->events()[1].of;
  EXPECT_NEAR(-now.contact.depth_m, std::sqrt(29.0) - 1, 1e-6);
  EXPECT_LT(now.contact.depth_error_m, 1e-12);
  EXPECT_EQ(world_.fences()->inside().size(), 1u);
}

TEST_F(NearestTest, WhoPassesBetweenTwoPosesIsToldAndSoIsWhoComesBack) {
  ask("post", "*", {.within_m = 20});
  add("post", {0, 0, 0}, 0, false);
  add("lamp", {0, 4, 0}, 0, false);
  const ObjectId drone = add("drone", {-30, 2, 0});
  pose(drone, {-30, 2, 0}, 1);
  step();
  EXPECT_EQ(told(), Lines{"began lamp"});
  pose(drone, {30, 2, 0}, 2);
  step();
  ASSERT_EQ(told(), (Lines{"ended lamp goes on", "began drone", "ended drone goes on", "began lamp"}));
  // Its surface is as near as the lamp's, 3 m away, where x * x + 4 = 16.
  expect_at(1, 1 + (30 - std::sqrt(12.0)) / 60);
  expect_at(3, 1 + (30 + std::sqrt(12.0)) / 60);
}

TEST_F(NearestTest, BeyondItsReachNobodyIsNearest) {
  ask("", "drone", {.within_m = 5, .hysteresis_m = 1});
  const ObjectId drone = add("drone", {20.5, 0, 0});
  pose(drone, {20.5, 0, 0}, 0);
  step();
  EXPECT_EQ(told(), Lines());
  pose(drone, {0.5, 0, 0}, 2);
  step();
  ASSERT_EQ(told(), Lines{"began drone"});
  expect_at(0, 1.5);
  pose(drone, {20.5, 0, 0}, 4);
  step();
  ASSERT_EQ(told(), Lines{"ended drone"});
  expect_at(0, 2.6);
}

TEST_F(NearestTest, ATieChangesNothingAndHysteresisAsksForMore) {
  ask("", "ball_*", {.within_m = 50, .hysteresis_m = 1});
  const ObjectId a = add("ball_a", {4, 0, 0});
  const ObjectId b = add("ball_b", {0, 4, 0});
  pose({{a, {4, 0, 0}}, {b, {0, 4, 0}}}, 0);
  step();
  EXPECT_EQ(told(), Lines{"began ball_a"}) << "of two as near the one whose name comes first";
  pose({{b, {0, 3.5, 0}}}, 1);
  step();
  EXPECT_EQ(told(), Lines());
  pose({{b, {0, 2.5, 0}}}, 2);
  step();
  ASSERT_EQ(told(), (Lines{"ended ball_a goes on", "began ball_b"}));
  expect_at(1, 1.5);
}

TEST_F(NearestTest, WhoIsTakenOutIsFollowedByTheNext) {
  ask("", "ball_*", {.within_m = 50});
  const ObjectId a = add("ball_a", {4, 0, 0});
  const ObjectId b = add("ball_b", {0, 6, 0});
  pose({{a, {4, 0, 0}}, {b, {0, 6, 0}}}, 0);
  step();
  world_.remove(a, EndReason::removed);
  step();
  EXPECT_EQ(told(), (Lines{"ended ? goes on removed", "began ball_b"}));
  world_.remove(b, EndReason::removed);
  step();
  EXPECT_EQ(told(), Lines{"ended ? removed"});
  add("ball_c", {0, 9, 0}, 0, false);
  step();
  EXPECT_EQ(told(), Lines{"began ball_c"}) << "what stands still is looked at, too";
}

TEST_F(NearestTest, WhoIsPutElsewhereJumps) {
  ask("", "ball_*", {.within_m = 50});
  const ObjectId a = add("ball_a", {4, 0, 0});
  const ObjectId b = add("ball_b", {0, 9, 0});
  pose({{a, {4, 0, 0}}, {b, {0, 9, 0}}}, 0);
  step();
  pose(b, {0, 2, 0}, 1, 1, true);
  step();
  ASSERT_EQ(told(), (Lines{"ended ball_a goes on", "began ball_b"}));
  expect_at(1, 1);
}

// Nothing is said of a time before both publishers have spoken of it.
TEST_F(NearestTest, ItWaitsForTheSlowerPublisher) {
  ask("", "ball_*", {.within_m = 50});
  const ObjectId a = add("ball_a", {4, 0, 0}, 1);
  const ObjectId b = add("ball_b", {0, 9, 0}, 2);
  pose(a, {4, 0, 0}, 0, 1);
  pose(b, {0, 9, 0}, 0, 2);
  step();
  pose(a, {14, 0, 0}, 2, 1);
  step();
  EXPECT_EQ(told(), Lines());
  // a is 4 + 5 t away, b 9: after 1 s.
  world_.advance(2, start_ns_ + 2 * kSecond_ns);
  step();
  ASSERT_EQ(told(), (Lines{"ended ball_a goes on", "began ball_b"}));
  expect_at(1, 1);
}

TEST_F(NearestTest, WhatItIsAboutMayComeAndGo) {
  ask("walker", "ball", {.within_m = 50});
  add("ball", {4, 0, 0}, 0, false);
  step();
  EXPECT_EQ(told(), Lines());
  const ObjectId walker = add("walker", {0, 0, 0});
  step();
  EXPECT_EQ(told(), Lines{"began ball"});
  world_.remove(walker, EndReason::removed);
  step();
  EXPECT_EQ(told(), Lines{"ended ball removed"});
  add("walker", {9, 0, 0});
  step();
  EXPECT_EQ(told(), Lines{"began ball"});
  EXPECT_TRUE(world_.remove_fence("near"));
  step();
  EXPECT_EQ(told(), Lines{"ended ball fence_removed"});
  EXPECT_FALSE(world_.remove_fence("near"));
}

TEST_F(NearestTest, ALostObjectIsInDoubtUntilItIsBack) {
  ask("", "ball", {.within_m = 50});
  const ObjectId ball = add("ball", {4, 0, 0}, 1, true, LostPolicy::freeze);
  pose(ball, {4, 0, 0}, 0);
  step();
  EXPECT_EQ(told(), Lines{"began ball"});
  world_.set_stale(ball, true);
  world_.lose(1);
  step();
  EXPECT_EQ(told(), (Lines{"ended ball goes on publisher_lost", "began ball in doubt"}));
  world_.set_stale(ball, false);
  pose(ball, {5, 0, 0}, 1);
  step();
  EXPECT_EQ(told(), (Lines{"ended ball goes on decided in doubt", "began ball"}));
}

// What does not change costs nothing: far movers are not looked at, and at rest nothing is.
TEST_F(NearestTest, WhatIsFarCostsNoLook) {
  ask("", "ball_*", {.within_m = 50});
  add("ball_a", {4, 0, 0}, 0, false);
  const ObjectId b = add("ball_b", {0, 40, 0});
  pose(b, {0, 40, 0}, 0);
  step();
  pose(b, {0, 30, 0}, 1);
  step();
  EXPECT_EQ(world_.fences()->cost().exact_tests, 0u);
  EXPECT_EQ(world_.fences()->cost().sweep_looks, 0u);
  step();
  EXPECT_EQ(world_.fences()->cost().exact_tests, 0u);
}

// The walker goes along the middle between two lamps: neither is ever surely nearer, and the search for it has a limit.
TEST_F(NearestTest, ATieAllTheWayHasALimitedCost) {
  ask("walker", "lamp_*", {.within_m = 50});
  add("lamp_a", {0, 3, 0}, 0, false);
  add("lamp_b", {0, -3, 0}, 0, false);
  const ObjectId walker = add("walker", {-9, 0, 0});
  pose(walker, {-9, 0, 0}, 0);
  step();
  EXPECT_EQ(told(), Lines{"began lamp_a"});
  pose(walker, {9, 0, 0}, 1);
  step();
  EXPECT_EQ(told(), Lines());
  EXPECT_LE(world_.fences()->cost().sweep_looks, 1'100u);
  EXPECT_EQ(world_.fences()->cost().sweeps_skipped, 1u);
  // From there on the other one is nearer; what was left open before does not widen that bracket.
  pose(walker, {9, -1, 0}, 2);
  step();
  ASSERT_EQ(told(), (Lines{"ended lamp_a goes on", "began lamp_b"}));
  expect_at(1, 1);
}

TEST_F(NearestTest, WhatCannotBeIsRefused) {
  EXPECT_EQ(refusal(question("", "*", {.within_m = 0})),
            "nearest 'near': it looks 0 m far; a finite distance above 0 is needed. Nothing was added");
  EXPECT_NE(refusal(question("", "*", {.within_m = 1, .hysteresis_m = -1})).find("its hysteresis is -1"),
            std::string::npos);
  EXPECT_EQ(refusal(question("", "*", {.within_m = 1})), "");
  EXPECT_NE(refusal(question("", "*", {.within_m = 1})).find("the name is taken"), std::string::npos);
}

}  // namespace
}  // namespace collided::engine
