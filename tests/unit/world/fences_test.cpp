// Fences: which objects are in a region, decided over whole motions, and reported once.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/solids/solid.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/unit/world/standing_fixture.hpp"

namespace collided::engine {
namespace {

class FencesTest : public StandingTest {
 protected:
  FencesTest() : StandingTest(wire_contract::kDefaultGapNs) {}

  ObjectId fence(const std::string& name, const Shape& shape, FenceDefinition rest = {}) {
    rest.name = name;
    rest.shape = shape;
    EXPECT_EQ(refusal(rest), "");
    return world_.fences()->find(name).value_or(0);
  }

  const Shape dock_ = box({2.5, 2.5, 1.5}, {2.5, 2.5, 1.5});
};

TEST_F(FencesTest, EntriesAndExitsAreReportedOnceWithBrackets) {
  fence("dock", dock_);
  const ObjectId drone = add("drone", ball(0.5), {-2, 1, 1});
  EXPECT_EQ(step_with(drone, {-2, 1, 1}, 0), Lines());
  ASSERT_EQ(step_with(drone, {2, 1, 1}, 1), Lines{"began drone dock"});
  // Its front is at x = -1.5 + 4 t: at 0 after 0.375 s.
  expect_at(0, 0.375);
  EXPECT_EQ(world_.fences()->inside().size(), 1u);
  EXPECT_EQ(step_with(drone, {2, 2, 1}, 2), Lines());
  ASSERT_EQ(step_with(drone, {10, 2, 1}, 3), Lines{"ended drone dock"});
  // Its back is at x = 1.5 + 8 (t - 2): at 5 after 2.4375 s.
  expect_at(0, 2.4375);
  EXPECT_TRUE(world_.fences()->inside().empty());
  EXPECT_EQ(world_.fences()->last_sequence(), 2u);
}

// A mover without a fence near it searches again only once it has left that place. New fences find it.
TEST_F(FencesTest, AFenceThatComesNearAMoverThatFoundNoneIsSeen) {
  fence("far", box({0.5, 2.5, 1.5}, {50.5, 2.5, 1.5}));
  const ObjectId drone = add("drone", ball(0.5), {0, 1, 1});
  double after_s = 0;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(step_with(drone, {0.01 * i, 1, 1}, after_s += 0.1), Lines());
  fence("near", box({0.65, 2.5, 1.5}, {1.35, 2.5, 1.5}));
  EXPECT_EQ(step(), Lines());
  EXPECT_EQ(step_with(drone, {0.1, 1, 1}, after_s += 0.1), Lines());
  EXPECT_EQ(step_with(drone, {0.25, 1, 1}, after_s += 0.1), Lines{"began drone near"});
  // So does a fence that moves there with its carrier.
  const ObjectId carrier = add("carrier", ball(0.1), {-20, 1, 1});
  fence("around", ball(1), {.carrier = "carrier"});
  for (int i = 0; i < 3; ++i) EXPECT_EQ(step_with(drone, {0.25, 1, 1 + 0.001 * i}, after_s += 0.1), Lines());
  EXPECT_EQ(step_with(carrier, {-1, 1, 1}, after_s += 0.1), Lines{"began drone around"});
}

// An object that enters and leaves between two poses has two events in the ledger, marked as one crossing.
TEST_F(FencesTest, WhatCrossesBetweenTwoPosesIsNotMissed) {
  fence("wire", box({0.005, 2.5, 1.5}, {0.005, 2.5, 1.5}));
  const ObjectId drone = start("drone", ball(0.1), {-2, 1, 1});
  step();
  ASSERT_EQ(step_with(drone, {2, 1, 1}, 0.1), (Lines{"began drone wire crossed", "ended drone wire crossed"}));
  // The centre is at x = -2 + 40 t; the two touch from x = -0.1 to 0.11.
  expect_at(0, 1.9 / 40);
  expect_at(1, 2.11 / 40);
}

TEST_F(FencesTest, AnObjectWithinANewFenceIsInIt) {
  start("drone", ball(0.1), {1, 1, 1});
  step();
  fence("dock", dock_);
  EXPECT_EQ(step(), Lines{"began drone dock"});
  EXPECT_TRUE(world_.remove_fence("dock"));
  EXPECT_FALSE(world_.remove_fence("dock"));
  EXPECT_EQ(step(), Lines{"ended drone dock fence_removed"});
  fence("dock", dock_);
  EXPECT_EQ(step(), Lines{"began drone dock"});
}

TEST_F(FencesTest, AFenceMakesNoContacts) {
  fence("dock", dock_);
  const ObjectId drone = add("drone", ball(0.5), {1, 1, 1});
  EXPECT_EQ(step_with(drone, {1, 1, 1}, 0), Lines{"began drone dock"});
  EXPECT_TRUE(world_.events().empty());
  EXPECT_TRUE(world_.contacts().empty());
  EXPECT_EQ(world_.last_event_sequence(), 0u);
}

TEST_F(FencesTest, AnExitSaysWhy) {
  fence("dock", dock_);
  const ObjectId first = start("first", ball(0.1), {1, 1, 1});
  const ObjectId second = start("second", ball(0.1), {2, 2, 2});
  EXPECT_EQ(step(), (Lines{"began first dock", "began second dock"}));
  world_.remove(first, EndReason::publisher_lost);
  EXPECT_EQ(step_with(second, {9, 9, 9}, 1, {.teleport = true}),
            (Lines{"ended ? dock publisher_lost", "ended second dock teleported"}));
}

TEST_F(FencesTest, AFrozenObjectIsInDoubtUntilItIsFoundAgain) {
  fence("dock", dock_);
  const ObjectId drone = start("drone", ball(0.1), {1, 1, 1}, {.lost = LostPolicy::freeze});
  step();
  world_.set_stale(drone, true);
  EXPECT_EQ(step(), (Lines{"ended drone dock publisher_lost", "began drone dock in doubt"}));
  world_.set_stale(drone, false);
  EXPECT_EQ(step(), (Lines{"ended drone dock decided in doubt", "began drone dock"}));
}

TEST_F(FencesTest, OnlyAndSkipAndMaskSelectObjects) {
  fence("forklifts", dock_, {.only = "forklift*", .skip = "*_7"});
  fence("people", dock_, {.mask = 2});
  add("forklift_6", ball(0.1), {1, 1, 1});
  add("forklift_7", ball(0.1), {2, 1, 1});
  add("drone", ball(0.1), {3, 1, 1});
  EXPECT_EQ(step(), Lines{"began forklift_6 forklifts"});
}

// A zone about a person: both the carrier and the monitored object move.
TEST_F(FencesTest, AFenceGoesWithItsCarrier) {
  const ObjectId person = add("person", ball(0.3), {0, 0, 0});
  const ObjectId robot = add("robot", ball(0.5), {5, 0, 0}, {.publisher = 2});
  fence("around", ball(1), {.carrier = "person"});
  pose(person, {0, 0, 0}, 0);
  EXPECT_EQ(step_with(robot, {5, 0, 0}, 0, {.publisher = 2}), Lines());
  // One second later the person is at x = 5; the two are 1.5 m apart when it is at 3.5. Known once both have poses.
  EXPECT_EQ(step_with(person, {5, 0, 0}, 1), Lines());
  ASSERT_EQ(step_with(robot, {5, 0, 0}, 2, {.publisher = 2}), Lines{"began robot around"});
  expect_at(0, 0.7);
  // Its carrier is not in it, and goes with it.
  world_.remove(person, EndReason::removed);
  EXPECT_EQ(step(), Lines{"ended robot around removed"});
  // The fence waits for an object of that name.
  add("person", ball(0.3), {5, 1, 0});
  EXPECT_EQ(step(), Lines{"began robot around"});
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
  const ObjectId drone = start("drone", ball(0.1), {5, 0, 0});
  step();
  EXPECT_EQ(step_with(drone, {0, 0, 0}, 1), Lines{"began drone dome"});
  EXPECT_EQ(step_with(drone, {0.2, 0, 0}, 2), Lines());
  EXPECT_EQ(step_with(drone, {-5, 0, 0}, 3), Lines{"ended drone dome"});
}

TEST_F(FencesTest, AHalfSpaceIsAFence) {
  Shape shape;
  shape.primitives.emplace_back(HalfSpace{.point = {0, 0, 1}, .normal = {0, 0, 1}});
  fence("below", shape);
  const ObjectId drone = add("drone", ball(0.5), {1e6, 0, 3});
  EXPECT_EQ(step_with(drone, {1e6, 0, 3}, 0), Lines());
  EXPECT_EQ(step_with(drone, {1e6, 0, 1}, 1), Lines{"began drone below"});
}

TEST_F(FencesTest, WhatHoldsNothingIsRefusedWithTheReason) {
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

// A slot that is used again gives another id, so that the new fence is not taken for the old one.
TEST_F(FencesTest, AFenceOfTheSameNameIsAnother) {
  const ObjectId first = fence("dock", ball(1));
  world_.remove_fence("dock");
  const ObjectId second = fence("dock", ball(1));
  EXPECT_NE(first, second);
  EXPECT_TRUE(is_fence(second));
}

}  // namespace
}  // namespace collided::engine
