// Configurations thought of on one state, beside every part with every other in a state that has them.
#include <gtest/gtest.h>

#include <algorithm>

#include "server/world/groups/what_if.hpp"
#include "tests/oracle/group_oracle.hpp"
#include "tests/oracle/mixed_world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

using oracle::PlainClearance;

class WhatIfTest : public testing::Test {
 protected:
  WhatIfTest() : state_(std::make_shared<Snapshot>(*world_.world.newest())) {
    for (std::size_t i = 0; i < world_.movers().size(); i += 9) moved_.push_back(world_.movers()[i]);
  }

  std::vector<ObjectId> others(const std::vector<ObjectId>& left_out) const {
    std::vector<ObjectId> ids;
    for (const auto& info : state_->objects) {
      if (info && std::find(left_out.begin(), left_out.end(), info->id) == left_out.end()) ids.push_back(info->id);
    }
    return ids;
  }
  std::vector<Pose> any_poses() {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < moved_.size(); ++i) poses.push_back(world_.pose());
    return poses;
  }
  /// The state in which the objects are there.
  Snapshot with(const std::vector<ObjectId>& ids, const std::vector<Pose>& poses) const {
    Snapshot there = *state_;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const std::uint32_t slot = slot_of(ids[i]);
      there.poses[slot] = poses[i];
    }
    return there;
  }
  /// Pairs that involve something moved, least first.
  std::vector<PlainClearance> plain(const std::vector<ObjectId>& moving, const std::vector<Pose>& poses) const {
    std::vector<ObjectId> all = others(moving);
    all.insert(all.end(), moving.begin(), moving.end());
    return oracle::plain_clearances(with(moving, poses), moving, all, false);
  }

  std::mt19937_64 random_ = oracle::seeded(6);
  oracle::MixedWorld world_{random_};
  std::shared_ptr<Snapshot> state_;
  std::vector<ObjectId> moved_;
  PartMeshes part_meshes_;
  Deadline never_;
};

void expect_as_plain(const WhatIfAnswer& answer, const std::vector<PlainClearance>& plain) {
  ASSERT_TRUE(answer.nearest);
  EXPECT_EQ(answer.touches == Decision::yes, plain.front().touches);
  EXPECT_LE(answer.nearest->clearance.low_m(), plain.front().high_m);
  EXPECT_GE(answer.nearest->clearance.high_m(), plain.front().low_m);
}

TEST_F(WhatIfTest, EachConfigurationIsAsIfTheWorldHadIt) {
  WhatIf what_if(state_, {.moved = moved_, .attached = {}, .against = others(moved_), .depth = true}, part_meshes_);
  int free_count = 0;
  for (int round = 0; round < 40; ++round) {
    const std::vector<Pose> poses = any_poses();
    const auto twin = plain(moved_, poses);
    expect_as_plain(what_if.at(poses, never_), twin);
    free_count += twin.front().touches ? 0 : 1;
  }
  EXPECT_GT(free_count, 0) << "every configuration touches, so no distance was compared";
  EXPECT_LT(free_count, 40) << "none touches";
}

// As if what is left out were not in the world.
TEST_F(WhatIfTest, WhatIsLeftOutGoesAlongAndCountsForNothing) {
  std::vector<ObjectId> left_out;
  std::vector<ObjectId> judged;
  for (std::size_t i = 0; i < moved_.size(); ++i) (i % 2 == 0 ? left_out : judged).push_back(moved_[i]);
  ASSERT_FALSE(judged.empty());
  WhatIf what_if(state_,
                 {.moved = moved_, .attached = {}, .against = others(moved_), .left_out = left_out, .depth = true},
                 part_meshes_);
  for (int round = 0; round < 20; ++round) {
    const std::vector<Pose> poses = any_poses();
    std::vector<ObjectId> all = others(moved_);
    all.insert(all.end(), judged.begin(), judged.end());
    const WhatIfAnswer answer = what_if.at(poses, never_);
    expect_as_plain(answer, oracle::plain_clearances(with(moved_, poses), judged, all, false));
    for (const ObjectId id : {answer.nearest->a, answer.nearest->b})
      EXPECT_EQ(std::count(left_out.begin(), left_out.end(), id), 0);
  }
}

TEST_F(WhatIfTest, WithoutDepthAContactHasItsNamesAndTheFreeTheirDistance) {
  WhatIf what_if(state_, {.moved = moved_, .attached = {}, .against = others(moved_)}, part_meshes_);
  for (int round = 0; round < 40; ++round) {
    const std::vector<Pose> poses = any_poses();
    const auto twin = plain(moved_, poses);
    const WhatIfAnswer answer = what_if.at(poses, never_);
    if (!twin.front().touches) {
      expect_as_plain(answer, twin);
      continue;
    }
    EXPECT_EQ(answer.touches, Decision::yes);
    ASSERT_TRUE(answer.nearest);
    const auto named = std::find_if(twin.begin(), twin.end(), [&](const PlainClearance& pair) {
      return std::minmax(pair.a, pair.b) == std::minmax(answer.nearest->a, answer.nearest->b);
    });
    ASSERT_NE(named, twin.end());
    EXPECT_TRUE(named->touches);
  }
}

TEST_F(WhatIfTest, WithinNothingOnlyContactsAreToldAndTheYesIsTheSame) {
  WhatIf what_if(state_, {.moved = moved_, .attached = {}, .against = others(moved_), .within_m = 0}, part_meshes_);
  for (int round = 0; round < 40; ++round) {
    const std::vector<Pose> poses = any_poses();
    const WhatIfAnswer answer = what_if.at(poses, never_);
    EXPECT_EQ(answer.touches == Decision::yes, plain(moved_, poses).front().touches);
    EXPECT_EQ(answer.nearest.has_value(), answer.touches == Decision::yes);
  }
}

TEST_F(WhatIfTest, AnAttachedObjectKeepsItsPlaceRelativeToItsParent) {
  const ObjectId parent = moved_[0];
  const ObjectId child = moved_[1];
  const ObjectId grandchild = moved_[2];
  WhatIf what_if(state_,
                 {.moved = {parent},
                  .attached = {{.child = child, .parent = parent}, {.child = grandchild, .parent = child}},
                  .against = others({parent, child, grandchild}),
                  .depth = true},
                 part_meshes_);
  const auto pose_of = [&](ObjectId id) { return state_->poses[slot_of(id)]; };
  for (int round = 0; round < 20; ++round) {
    const Pose there = world_.pose();
    const Pose carried = composed(there, inverse(pose_of(parent)));
    const std::vector<Pose> all{there, composed(carried, pose_of(child)), composed(carried, pose_of(grandchild))};
    const auto twin = plain({parent, child, grandchild}, all);
    const WhatIfAnswer answer = what_if.at(std::vector{there}, never_);
    // The chain of poses is rounded in another order.
    constexpr double kChainRounding = 1e-12;
    ASSERT_TRUE(answer.nearest);
    EXPECT_LE(answer.nearest->clearance.low_m(), twin.front().high_m + kChainRounding);
    EXPECT_GE(answer.nearest->clearance.high_m(), twin.front().low_m - kChainRounding);
  }
}

TEST_F(WhatIfTest, OutsideOfWhatIsCoveredNothingIsFree) {
  const auto cover = [&](double half_m) {
    state_->covers = std::make_shared<const std::vector<Aabb>>(
        1, Aabb{.low = Vec3::Constant(-half_m), .high = Vec3::Constant(half_m)});
  };
  const std::vector<ObjectId> one(1, moved_.front());
  const WhatIfAsk contacts{.moved = one, .attached = {}, .against = {}, .within_m = 0};
  const auto at = [&](const WhatIfAsk& ask, double x) {
    return WhatIf(state_, ask, part_meshes_).at(std::vector<Pose>{{.position = {x, 0, 0}}}, never_);
  };
  EXPECT_EQ(at(contacts, 1e6).touches, Decision::no) << "without a word about it all is covered";
  cover(1e3);
  EXPECT_EQ(at(contacts, 0).touches, Decision::no);
  const WhatIfAnswer far = at(contacts, 1e6);
  EXPECT_EQ(far.touches, Decision::undecided);
  ASSERT_TRUE(far.uncovered);
  // A clearance claims the space up to it.
  WhatIfAsk within = contacts;
  within.within_m = 100;
  EXPECT_EQ(at(within, 0).touches, Decision::no);
  within.within_m = 1e4;
  EXPECT_EQ(at(within, 0).touches, Decision::undecided);
  // A contact is one wherever it is; nothing else is known there.
  cover(1e-9);
  WhatIf anywhere(state_, {.moved = moved_, .attached = {}, .against = others(moved_)}, part_meshes_);
  int contacts_seen = 0;
  for (int round = 0; round < 40; ++round) {
    const std::vector<Pose> poses = any_poses();
    const WhatIfAnswer answer = anywhere.at(poses, never_);
    ASSERT_EQ(answer.touches, plain(moved_, poses).front().touches ? Decision::yes : Decision::undecided);
    ASSERT_EQ(answer.uncovered.has_value(), answer.touches != Decision::yes);
    contacts_seen += answer.touches == Decision::yes ? 1 : 0;
  }
  EXPECT_GT(contacts_seen, 0);
}

TEST_F(WhatIfTest, TheStateStaysAsItIs) {
  const std::vector<Pose> before = state_->poses;
  WhatIf what_if(state_, {.moved = moved_, .attached = {}, .against = others(moved_)}, part_meshes_);
  what_if.at(any_poses(), never_);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(state_->poses[i].position, before[i].position);
}

TEST_F(WhatIfTest, ADeadlineThatIsOverLeavesAConfigurationOpen) {
  WhatIf what_if(state_, {.moved = moved_, .attached = {}, .against = others(moved_)}, part_meshes_);
  Deadline over(1);
  const WhatIfAnswer answer = what_if.at(any_poses(), over);
  EXPECT_TRUE(answer.is_late);
  EXPECT_EQ(answer.touches, Decision::undecided);
}

}  // namespace
}  // namespace collided::engine
