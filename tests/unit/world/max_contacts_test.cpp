// More contacts than a step may find: some are told, none is told wrongly, and it is said that there are more.
#include <gtest/gtest.h>

#include <set>

#include "server/world/query/plan.hpp"
#include "server/world/world.hpp"

namespace collided::engine {
namespace {

class WorldMaxContacts : public ::testing::Test {
 protected:
  void add(std::size_t count, const Primitive& shape) {
    for (std::size_t i = 0; i < count; ++i) {
      ObjectDefinition definition;
      definition.name = "mover " + std::to_string(ids_.size());
      definition.shape.primitives = {shape};
      ids_.push_back(std::get<ObjectId>(world_.define(definition)));
    }
  }
  void put(std::size_t mover, const Vec3& place) {
    ASSERT_TRUE(world_.move(ids_[mover], {.position = place, .rotation = Quat::Identity()}, now_ns_, false));
  }
  void step() {
    now_ns_ += 1'000'000;
    ASSERT_TRUE(world_.step(now_ns_, 1, {.contacts = false, .persisted = false}));
    for (const Event& event : world_.events()) {
      const std::pair pair(event.of.a, event.of.b);
      if (event.kind == EventKind::began) {
        EXPECT_TRUE(told_.insert(pair).second) << "began twice";
      } else {
        EXPECT_EQ(told_.erase(pair), 1u) << "ended without having begun";
      }
    }
    EXPECT_EQ(told_.size(), world_.contacts().size());
    EXPECT_LE(told_.size(), 10u);
  }
  bool plan_says_so() const {
    for (const PlanRow& row : plan_of(*world_.newest(), true)) {
      if (row.reason.find("truncated") != std::string::npos) return true;
    }
    return false;
  }

  World world_{WorldOptions{.max_contacts = 10}};
  std::vector<ObjectId> ids_;
  std::set<std::pair<ObjectId, ObjectId>> told_;
  std::int64_t now_ns_ = 0;
};

// Twenty balls in one place are 190 pairs.
TEST_F(WorldMaxContacts, OnlySoManyAreToldAndItIsSaid) {
  add(20, Sphere{.center = Vec3::Zero(), .radius_m = 1});
  step();
  EXPECT_EQ(world_.contacts().size(), 10u);
  EXPECT_TRUE(world_.cost().truncated);
  EXPECT_TRUE(plan_says_so());
  step();
  EXPECT_TRUE(world_.cost().truncated) << "nothing has moved, so there are still more";
}

TEST_F(WorldMaxContacts, WhatHoldsIsNotEndedByASearchCutShort) {
  add(20, Sphere{.center = Vec3::Zero(), .radius_m = 1});
  step();
  const auto before = told_;
  // The order in which pairs are met changes; who touches does not.
  for (int round = 0; round < 5; ++round) {
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      put(i, Vec3(static_cast<double>((i * 7 + static_cast<std::size_t>(round) * 3) % 20) * 0.05, 0, 0));
    }
    step();
    EXPECT_EQ(told_, before);
  }
}

TEST_F(WorldMaxContacts, WhatHoldsOutlastsASearchCutShortWhicheverOfTheTwoMoves) {
  add(20, Sphere{.center = Vec3::Zero(), .radius_m = 1});
  step();
  const auto before = told_;
  for (std::size_t round = 0; round < 12; ++round) {
    for (std::size_t i = round % 2; i < ids_.size(); i += 2)
      put(i, Vec3(static_cast<double>((i * 7 + round * 3) % 20) * 0.05, 0, 0));
    step();
    EXPECT_EQ(told_, before) << round;
    EXPECT_TRUE(world_.cost().truncated);
  }
}

TEST_F(WorldMaxContacts, EndsAreToldWhileTruncated) {
  add(20, Sphere{.center = Vec3::Zero(), .radius_m = 1});
  step();
  const auto [a, b] = *told_.begin();
  const std::size_t mover = static_cast<std::size_t>(std::find(ids_.begin(), ids_.end(), a) - ids_.begin());
  put(mover, Vec3(100, 0, 0));
  step();
  for (const auto& pair : told_) EXPECT_TRUE(pair.first != a && pair.second != a);
  EXPECT_TRUE(world_.cost().truncated);
  (void)b;
}

// Three balls stay together and never move again: their pairs are found once there is room, whoever moves.
TEST_F(WorldMaxContacts, WhatWasLeftOutBeginsOnceThereIsRoom) {
  add(20, Sphere{.center = Vec3::Zero(), .radius_m = 1});
  step();
  for (std::size_t i = 3; i < ids_.size(); ++i) put(i, Vec3(10.0 * static_cast<double>(i), 0, 0));
  step();
  put(19, Vec3(0, 500, 0));
  step();
  EXPECT_FALSE(world_.cost().truncated);
  EXPECT_FALSE(plan_says_so());
  EXPECT_EQ(told_.size(), 3u);
}

// Parallel rods across their boxes' diagonals: every pair is a candidate and none touches.
TEST_F(WorldMaxContacts, CandidatesWithoutContactAreBoundedToo) {
  add(100, Capsule{.a = Vec3(0, 0, 0), .b = Vec3(100, 100, 0), .radius_m = 0.1});
  for (std::size_t i = 0; i < ids_.size(); ++i) put(i, Vec3(static_cast<double>(i), 0, 0));
  step();
  EXPECT_TRUE(world_.cost().truncated);
  EXPECT_LE(world_.cost().candidate_pairs, 160u);
  EXPECT_TRUE(told_.empty());
}

}  // namespace
}  // namespace collided::engine
