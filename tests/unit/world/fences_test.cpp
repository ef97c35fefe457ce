// Fences: who is in a region, decided over whole motions, and told once.
#include "server/world/fences/fences.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/solids/solid.hpp"
#include "server/world/world.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

Shape box_from(const Vec3& low, const Vec3& high) {
  Shape shape;
  shape.primitives.emplace_back(Box{.center = (low + high) / 2, .half_m = (high - low) / 2});
  return shape;
}

Shape ball(double radius_m, const Vec3& center = Vec3::Zero()) {
  Shape shape;
  shape.primitives.emplace_back(Sphere{center, radius_m});
  return shape;
}

class FencesTest : public testing::Test {
 protected:
  FencesTest() { step(); }

  ObjectId add(const std::string& name, const Shape& shape, const Vec3& at, std::uint64_t publisher = 0,
               LostPolicy lost = LostPolicy::remove) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape = shape;
    definition.pose.position = at;
    definition.publisher = publisher;
    definition.lost_policy = lost;
    return std::get<ObjectId>(world_.define(definition));
  }

  ObjectId fence(const std::string& name, const Shape& shape, FenceDefinition rest = {}) {
    rest.name = name;
    rest.shape = shape;
    const auto added = world_.add_fence(rest);
    EXPECT_TRUE(std::holds_alternative<ObjectId>(added));
    return std::holds_alternative<ObjectId>(added) ? std::get<ObjectId>(added) : 0;
  }

  /// Publisher 1 says where the object is after so many seconds.
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

  /// What the last step told: "enter ball dock", "exit ball dock removed".
  std::vector<std::string> told() const {
    std::vector<std::string> lines;
    if (world_.fences() == nullptr) return lines;
    for (const Event& event : world_.fences()->events()) {
      static constexpr const char* kReasons[] = {
          "",           "separated",        "removed",         "publisher_lost",
          "teleported", "geometry_changed", "server_stopping", "server_restarted",
          "decided",    "crossed",          "fence_removed"};
      const ObjectInfo* info = world_.info(event.of.a);
      lines.push_back(std::string(event.kind == EventKind::began ? "enter " : "exit ") +
                      (info != nullptr ? info->name : "?") + " " + std::string(world_.fences()->name(event.of.b)));
      const std::string reason = kReasons[static_cast<std::size_t>(event.reason)];
      if (!reason.empty() && reason != "separated") lines.back() += " " + reason;
      if (event.of.doubt != Doubt::none) lines.back() += " in doubt";
    }
    return lines;
  }

  /// Seconds after the start between which the last step's event number i happened.
  std::pair<double, double> bracket(std::size_t i) const {
    const Event& event = world_.fences()->events().at(i);
    const auto after = [&](double ago_s) { return 1e-9 * static_cast<double>(now_ns_ - start_ns_) - ago_s; };
    return {after(event.bracket_low_s), after(event.bracket_high_s)};
  }

  using Lines = std::vector<std::string>;
  std::int64_t start_ns_ = 1'000 * kSecond;
  std::int64_t now_ns_ = start_ns_;
  World world_{WorldOptions{}};
};

TEST_F(FencesTest, WhoComesInAndGoesOutIsToldOnceWithBrackets) {
  fence("dock", box_from({0, 0, 0}, {5, 5, 3}));
  const ObjectId drone = add("drone", ball(0.5), {-2, 1, 1}, 1);
  pose(drone, {-2, 1, 1}, 0);
  step();
  EXPECT_EQ(told(), Lines());
  pose(drone, {2, 1, 1}, 1);
  step();
  ASSERT_EQ(told(), Lines{"enter drone dock"});
  // Its front is at x = -1.5 + 4 t: at 0 after 0.375 s.
  EXPECT_LE(bracket(0).first, 0.375);
  EXPECT_GE(bracket(0).second, 0.375);
  EXPECT_LT(bracket(0).second - bracket(0).first, 1e-6);
  EXPECT_EQ(world_.fences()->inside().size(), 1u);
  pose(drone, {2, 2, 1}, 2);
  step();
  EXPECT_EQ(told(), Lines());
  pose(drone, {10, 2, 1}, 3);
  step();
  ASSERT_EQ(told(), Lines{"exit drone dock"});
  // Its back is at x = 1.5 + 8 (t - 2): at 5 after 2.4375 s.
  EXPECT_LE(bracket(0).first, 2.4375);
  EXPECT_GE(bracket(0).second, 2.4375);
  EXPECT_TRUE(world_.fences()->inside().empty());
  EXPECT_EQ(world_.fences()->last_sequence(), 2u);
}

// A mover that found no fence about it does not look for one as long as it stays there, but for those that come.
TEST_F(FencesTest, AFenceThatComesNearAMoverThatFoundNoneIsSeen) {
  fence("far", box_from({50, 0, 0}, {51, 5, 3}));
  const ObjectId drone = add("drone", ball(0.5), {0, 1, 1}, 1);
  double after_s = 0;
  for (int i = 0; i < 5; ++i) {
    pose(drone, {0.01 * i, 1, 1}, after_s += 0.1);
    step();
    EXPECT_EQ(told(), Lines());
  }
  fence("near", box_from({0.7, 0, 0}, {2, 5, 3}));
  step();
  EXPECT_EQ(told(), Lines());
  pose(drone, {0.1, 1, 1}, after_s += 0.1);
  step();
  EXPECT_EQ(told(), Lines());
  pose(drone, {0.25, 1, 1}, after_s += 0.1);
  step();
  EXPECT_EQ(told(), Lines{"enter drone near"});
  // And one that moves there with its carrier.
  FenceDefinition carried;
  carried.carrier = "carrier";
  const ObjectId carrier = add("carrier", ball(0.1), {-20, 1, 1}, 1);
  fence("around", ball(1), carried);
  for (int i = 0; i < 3; ++i) {
    pose(drone, {0.25, 1, 1 + 0.001 * i}, after_s += 0.1);
    step();
    EXPECT_EQ(told(), Lines());
  }
  pose(carrier, {-1, 1, 1}, after_s += 0.1);
  step();
  EXPECT_EQ(told(), Lines{"enter drone around"});
}

// In and out between two poses: both are told, marked as one passage.
TEST_F(FencesTest, WhatCrossesBetweenTwoPosesIsNotMissed) {
  fence("wire", box_from({0, 0, 0}, {0.01, 5, 3}));
  const ObjectId drone = add("drone", ball(0.1), {-2, 1, 1}, 1);
  pose(drone, {-2, 1, 1}, 0);
  step();
  pose(drone, {2, 1, 1}, 0.1);
  step();
  ASSERT_EQ(told(), (Lines{"enter drone wire crossed", "exit drone wire crossed"}));
  // The centre is at x = -2 + 40 t; the two touch from x = -0.1 to 0.11.
  EXPECT_LE(bracket(0).first, 1.9 / 40);
  EXPECT_GE(bracket(0).second, 1.9 / 40);
  EXPECT_LE(bracket(1).first, 2.11 / 40);
  EXPECT_GE(bracket(1).second, 2.11 / 40);
  EXPECT_LT(bracket(1).second - bracket(1).first, 1e-6);
}

TEST_F(FencesTest, WhoIsThereWhenAFenceComesIsInIt) {
  const ObjectId drone = add("drone", ball(0.1), {1, 1, 1}, 1);
  pose(drone, {1, 1, 1}, 0);
  step();
  fence("dock", box_from({0, 0, 0}, {5, 5, 3}));
  step();
  EXPECT_EQ(told(), Lines{"enter drone dock"});
  EXPECT_TRUE(world_.remove_fence("dock"));
  EXPECT_FALSE(world_.remove_fence("dock"));
  step();
  EXPECT_EQ(told(), Lines{"exit drone dock fence_removed"});
  fence("dock", box_from({0, 0, 0}, {5, 5, 3}));
  step();
  EXPECT_EQ(told(), Lines{"enter drone dock"});
}

TEST_F(FencesTest, AFenceTouchesNothingAndNoContactIsTold) {
  fence("dock", box_from({0, 0, 0}, {5, 5, 3}));
  const ObjectId drone = add("drone", ball(0.5), {1, 1, 1}, 1);
  pose(drone, {1, 1, 1}, 0);
  step();
  EXPECT_EQ(told(), Lines{"enter drone dock"});
  EXPECT_TRUE(world_.events().empty());
  EXPECT_TRUE(world_.contacts().empty());
  EXPECT_EQ(world_.last_event_sequence(), 0u);
}

TEST_F(FencesTest, AnExitSaysWhy) {
  fence("dock", box_from({0, 0, 0}, {5, 5, 3}));
  const ObjectId first = add("first", ball(0.1), {1, 1, 1}, 1);
  const ObjectId second = add("second", ball(0.1), {2, 2, 2}, 1);
  pose(first, {1, 1, 1}, 0);
  pose(second, {2, 2, 2}, 0);
  step();
  EXPECT_EQ(told().size(), 2u);
  world_.remove(first, EndReason::publisher_lost);
  pose(second, {9, 9, 9}, 1, 1, true);
  step();
  EXPECT_EQ(told(), (Lines{"exit ? dock publisher_lost", "exit second dock teleported"}));
}

TEST_F(FencesTest, AFrozenObjectIsInDoubtUntilItIsFoundAgain) {
  fence("dock", box_from({0, 0, 0}, {5, 5, 3}));
  const ObjectId drone = add("drone", ball(0.1), {1, 1, 1}, 1, LostPolicy::freeze);
  pose(drone, {1, 1, 1}, 0);
  step();
  world_.set_stale(drone, true);
  step();
  EXPECT_EQ(told(), (Lines{"exit drone dock publisher_lost", "enter drone dock in doubt"}));
  world_.set_stale(drone, false);
  step();
  EXPECT_EQ(told(), (Lines{"exit drone dock decided in doubt", "enter drone dock"}));
}

TEST_F(FencesTest, OnlyAndSkipAndMaskSayWhomItLooksAt) {
  fence("forklifts", box_from({0, 0, 0}, {5, 5, 3}), {.only = "forklift*", .skip = "*_7"});
  fence("people", box_from({0, 0, 0}, {5, 5, 3}), {.mask = 2});
  add("forklift_6", ball(0.1), {1, 1, 1}, 1);
  add("forklift_7", ball(0.1), {2, 1, 1}, 1);
  add("drone", ball(0.1), {3, 1, 1}, 1);
  step();
  EXPECT_EQ(told(), Lines{"enter forklift_6 forklifts"});
}

// A zone about a person: both the one who carries it and those whom it looks at move.
TEST_F(FencesTest, AFenceGoesWithItsCarrier) {
  const ObjectId person = add("person", ball(0.3), {0, 0, 0}, 1);
  const ObjectId robot = add("robot", ball(0.5), {5, 0, 0}, 2);
  fence("around", ball(1), {.carrier = "person"});
  pose(person, {0, 0, 0}, 0, 1);
  pose(robot, {5, 0, 0}, 0, 2);
  step();
  EXPECT_EQ(told(), Lines());
  // One second later the person is at x = 5; the two are 1.5 m apart when it is at 3.5. Known once both have spoken.
  pose(person, {5, 0, 0}, 1, 1);
  step();
  EXPECT_EQ(told(), Lines());
  pose(robot, {5, 0, 0}, 2, 2);
  step();
  ASSERT_EQ(told(), Lines{"enter robot around"});
  EXPECT_LE(bracket(0).first, 0.7);
  EXPECT_GE(bracket(0).second, 0.7);
  EXPECT_LT(bracket(0).second - bracket(0).first, 1e-6);
  // Its carrier is not in it, and goes with it.
  world_.remove(person, EndReason::removed);
  step();
  EXPECT_EQ(told(), Lines{"exit robot around removed"});
  // The fence waits for somebody of that name.
  add("person", ball(0.3), {5, 1, 0}, 1);
  step();
  EXPECT_EQ(told(), Lines{"enter robot around"});
}

TEST_F(FencesTest, ASolidMeshHoldsWhatLiesWithinIt) {
  auto mesh = std::make_shared<TriangleMesh>(scenes::icosphere(3, 2));
  FenceDefinition definition;
  SolidFindings findings;
  definition.solid =
      solid_within(indexed_mesh(mesh, Bvh::build(*mesh, {.threads = 1, .progress = {}, .cancelled = {}})), findings);
  ASSERT_TRUE(definition.solid) << findings.refusal;
  Shape shape;
  shape.mesh = mesh;
  fence("dome", shape, definition);
  const ObjectId drone = add("drone", ball(0.1), {5, 0, 0}, 1);
  pose(drone, {5, 0, 0}, 0);
  step();
  pose(drone, {0, 0, 0}, 1);
  step();
  EXPECT_EQ(told(), Lines{"enter drone dome"});
  pose(drone, {0.2, 0, 0}, 2);
  step();
  EXPECT_EQ(told(), Lines());
  pose(drone, {-5, 0, 0}, 3);
  step();
  EXPECT_EQ(told(), Lines{"exit drone dome"});
}

TEST_F(FencesTest, AHalfSpaceIsAFence) {
  Shape shape;
  shape.primitives.emplace_back(HalfSpace{.point = {0, 0, 1}, .normal = {0, 0, 1}});
  fence("below", shape);
  const ObjectId drone = add("drone", ball(0.5), {1e6, 0, 3}, 1);
  pose(drone, {1e6, 0, 3}, 0);
  step();
  EXPECT_EQ(told(), Lines());
  pose(drone, {1e6, 0, 1}, 1);
  step();
  EXPECT_EQ(told(), Lines{"enter drone below"});
}

TEST_F(FencesTest, WhatHoldsNothingIsRefusedWithTheReason) {
  const auto refusal = [&](const FenceDefinition& definition) {
    const auto added = world_.add_fence(definition);
    return std::holds_alternative<Refusal>(added) ? std::get<Refusal>(added).reason : std::string();
  };
  EXPECT_NE(refusal({.name = "a", .shape = {}}).find("no shape"), std::string::npos);
  Shape half_space;
  half_space.primitives.emplace_back(HalfSpace{.point = {0, 0, 0}, .normal = {0, 0, 1}});
  EXPECT_NE(refusal({.name = "a", .shape = half_space, .carrier = "x"}).find("half-space"), std::string::npos);
  Shape surface;
  surface.mesh = std::make_shared<TriangleMesh>(scenes::icosphere(1, 1));
  EXPECT_NE(refusal({.name = "a", .shape = surface}).find("surface"), std::string::npos);
  EXPECT_EQ(refusal({.name = "a", .shape = ball(1)}), "");
  EXPECT_NE(refusal({.name = "a", .shape = ball(1)}).find("taken"), std::string::npos);
  EXPECT_EQ(world_.fences()->table().count(), 1u);
}

// A slot that is used again gives another id, so that nobody takes the new fence for the old one.
TEST_F(FencesTest, AFenceOfTheSameNameIsAnother) {
  const ObjectId first = fence("dock", ball(1));
  world_.remove_fence("dock");
  const ObjectId second = fence("dock", ball(1));
  EXPECT_NE(first, second);
  EXPECT_TRUE(is_fence(second));
}

}  // namespace
}  // namespace collided::engine
