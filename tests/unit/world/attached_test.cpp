// Objects that move along with others, beside the same objects moved by the publisher itself.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

constexpr std::uint64_t kRobot = 7;
constexpr std::uint64_t kOther = 9;
constexpr std::int64_t kFirst = 1'000'000'000'000;
constexpr std::int64_t kTick = 10'000'000;

/// What a subscriber hears of a pair, in the publishers' time.
struct Heard {
  EventKind kind;
  EndReason reason;
  std::int64_t low_ns;
  std::int64_t high_ns;
  /// The same change. A bracket is narrower where a pair was decided on common time, which rounds to nanoseconds.
  bool agrees_with(const Heard& other) const {
    constexpr std::int64_t kRoundingNs = 3;
    return kind == other.kind && reason == other.reason && low_ns <= other.high_ns + kRoundingNs &&
           other.low_ns <= high_ns + kRoundingNs;
  }
};
using HeardOfPairs = std::map<std::string, std::vector<Heard>>;

class AttachedObjects : public testing::Test {
 protected:
  struct Here {
    World world{WorldOptions{}};
    HeardOfPairs heard;
    std::int64_t now_ns = kFirst;

    ObjectId add(const std::string& name, const Vec3& place, std::uint64_t publisher = 0, bool moving = true,
                 double half_m = 0.5) {
      ObjectDefinition object;
      object.name = name;
      object.shape.primitives.emplace_back(Box{.center = Vec3::Zero(), .half_m = Vec3::Constant(half_m)});
      object.pose.position = place;
      object.publisher = publisher;
      object.moving = moving;
      return std::get<ObjectId>(world.define(object));
    }
    void step(std::int64_t ahead_ns = 1) {
      ASSERT_TRUE(world.step(now_ns += ahead_ns, 1, {}));
      for (const Event& event : world.events()) {
        const auto at = [&](double ago_s) { return now_ns - std::llround(ago_s * 1e9); };
        const ObjectInfo* a = world.info(event.of.a);
        const ObjectInfo* b = world.info(event.of.b);
        if (a == nullptr || b == nullptr) continue;
        const std::string pair = a->name < b->name ? a->name + " " + b->name : b->name + " " + a->name;
        heard[pair].push_back({event.kind, event.reason, at(event.bracket_low_s), at(event.bracket_high_s)});
      }
    }
    Pose pose(ObjectId id) const { return world.newest()->poses[slot_of(id)]; }
  };

  Pose any_pose(double reach_m) {
    std::uniform_real_distribution<double> place(-reach_m, reach_m);
    std::normal_distribution<double> turn;
    return {.position = {place(random_), place(random_), place(random_)},
            .rotation = Quat(turn(random_), turn(random_), turn(random_), turn(random_)).normalized()};
  }

  std::mt19937_64 random_ = oracle::seeded(24);
};

TEST_F(AttachedObjects, TheChildKeepsItsPlaceRelativeToItsParent) {
  Here here;
  const ObjectId hand = here.add("hand", {0, 0, 0}, kRobot);
  const ObjectId crate = here.add("crate", {2, 0, 0});
  const ObjectId label = here.add("label", {2, 2, 0});
  here.step();
  EXPECT_FALSE(here.world.attach(label, crate));  // a chain
  EXPECT_FALSE(here.world.attach(crate, hand));
  here.step();
  const Quat quarter(std::sqrt(0.5), 0, 0, std::sqrt(0.5));
  here.world.move(hand, {.position = {10, 0, 0}, .rotation = quarter}, here.now_ns, false);
  here.step();
  EXPECT_LT((here.pose(crate).position - Vec3(10, 2, 0)).norm(), 1e-14);
  EXPECT_LT((here.pose(label).position - Vec3(8, 2, 0)).norm(), 1e-14);
  EXPECT_LT(here.pose(label).rotation.angularDistance(quarter), 1e-14);
  EXPECT_TRUE(here.world.detach(crate));
  EXPECT_FALSE(here.world.detach(crate));
  here.step();
  here.world.move(hand, {}, here.now_ns, false);
  here.step();
  EXPECT_LT((here.pose(crate).position - Vec3(10, 2, 0)).norm(), 1e-14);
  // A thousand poses later nothing has crept in.
  EXPECT_FALSE(here.world.attach(crate, hand));
  here.step();
  const Pose before = here.pose(crate);
  for (int i = 0; i < 1'000; ++i) {
    here.world.move(hand, any_pose(100), here.now_ns, true);
    here.step();
  }
  here.world.move(hand, {}, here.now_ns, true);
  here.step();
  EXPECT_LT((here.pose(crate).position - before.position).norm(), 1e-13);
}

// Else a server that learns of the parent, the child and the place afterwards would have another world, by a rounding.
TEST_F(AttachedObjects, WhereTheChildIsFollowsFromItsParentFromTheBeginning) {
  std::mt19937_64 random = oracle::seeded(20261129);
  std::uniform_real_distribution<double> part(-20, 20);
  int rounded = 0;
  for (int i = 0; i < 100; ++i) {
    Here one;
    const ObjectId parent = one.add("parent", Vec3(part(random), part(random), part(random)), kRobot);
    const ObjectId child = one.add("child", Vec3(part(random), part(random), part(random)));
    one.world.advance(kRobot, one.now_ns);
    one.step();
    const Vec3 before = one.world.newest()->poses[slot_of(child)].position;
    ASSERT_FALSE(one.world.attach(child, parent));
    one.step();
    const SnapshotRing::Lease state = one.world.newest();
    const Pose placed = composed(state->poses[slot_of(parent)], one.world.attachments().find(child)->in_parent);
    EXPECT_EQ(state->poses[slot_of(child)].position, placed.position);
    EXPECT_EQ(state->poses[slot_of(child)].rotation.coeffs(), placed.rotation.coeffs());
    EXPECT_LT((placed.position - before).norm(), 1e-13);
    rounded += placed.position != before ? 1 : 0;
  }
  EXPECT_GT(rounded, 0) << "the test is to see some";
}

TEST_F(AttachedObjects, WhatCannotBeAttachedIsRefusedWithTheReason) {
  Here here;
  const ObjectId hand = here.add("hand", {0, 0, 0}, kRobot);
  const ObjectId crate = here.add("crate", {2, 0, 0});
  const ObjectId label = here.add("label", {2, 2, 0});
  const ObjectId wall = here.add("wall", {9, 0, 0}, 0, false);
  here.step();
  const auto why = [&](ObjectId child, ObjectId parent) {
    const std::optional<Refusal> refusal = here.world.attach(child, parent);
    return refusal ? refusal->reason : std::string();
  };
  EXPECT_EQ(why(crate, wall),
            "object 'crate' cannot be attached: 'wall' stands still, so there is nothing to follow. "
            "Nothing was attached");
  EXPECT_EQ(why(wall, hand),
            "object 'wall' cannot be attached: it was added as static and stays where it is. Nothing was attached");
  EXPECT_EQ(why(hand, crate), "object 'hand' cannot be attached: its poses are its publisher's. Nothing was attached");
  EXPECT_EQ(why(crate, crate),
            "object 'crate' cannot be attached: it is the same object as its parent. Nothing was attached");
  EXPECT_EQ(why(label, crate), "");
  EXPECT_EQ(why(label, hand),
            "object 'label' cannot be attached: it is attached to 'crate' already; detach it first. "
            "Nothing was attached");
  EXPECT_EQ(why(crate, label), "object 'crate' cannot be attached: 'label' moves along with it. Nothing was attached");
}

// The parent is swept from pose to pose, and so is what it carries: contacts between two poses are told, within
// the same brackets as if the publisher had moved both.
TEST_F(AttachedObjects, EventsAreThoseOfTheSameObjectsMovedByThePublisher) {
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(round);
    Here attached;
    Here moved;
    const bool streamed = round % 4 == 3;
    std::vector<ObjectId> hands;
    std::vector<ObjectId> crates;
    std::vector<ObjectId> drones;
    std::vector<ObjectId> carts;
    for (Here* here : {&attached, &moved}) {
      hands.push_back(here->add("hand", {0, 0, 0}, kRobot));
      drones.push_back(here->add("drone", {0, 0, 40}, kOther));
      carts.push_back(here->add("cart", {0, 40, 0}));
      for (int i = 0; i < 12; ++i) {
        std::mt19937_64 places(static_cast<std::uint64_t>(100 * round + i));
        std::uniform_real_distribution<double> place(-6, 6);
        here->add("post" + std::to_string(i), {place(places), place(places), place(places)}, 0, false, 0.3);
      }
      crates.push_back(here->add("crate", {2, 0.5, 0}, here == &moved ? kRobot : 0));
      for (const std::uint64_t publisher : {kRobot, kOther}) here->world.advance(publisher, kFirst);
      here->step();
    }
    ASSERT_FALSE(attached.world.attach(crates[0], hands[0]));
    const Pose in_parent = attached.world.attachments().find(crates[0])->in_parent;
    for (Here* here : {&attached, &moved}) {
      here->step();
      here->heard.clear();
    }
    for (int tick = 1; tick <= 30; ++tick) {
      const Pose of_hand = any_pose(5);
      const Pose of_drone = any_pose(5);
      const Pose of_cart = any_pose(5);
      const std::int64_t time_ns = kFirst + tick * kTick;
      // The other publisher is sometimes late, and then catches up.
      const bool comes = tick % 5 != 2;
      for (std::size_t i = 0; i < 2; ++i) {
        Here& here = i == 0 ? attached : moved;
        std::vector<ObjectId> ids{hands[i]};
        std::vector<Pose> poses{of_hand};
        if (i == 1) {
          ids.push_back(crates[i]);
          poses.push_back(composed(of_hand, in_parent));
        }
        bool done[2] = {};
        here.world.move(ids, poses, time_ns, false, std::span(done, ids.size()), streamed);
        here.world.advance(kRobot, time_ns);
        if (comes) {
          here.world.move(drones[i], of_drone, time_ns - kTick / 3, false);
          here.world.advance(kOther, time_ns - kTick / 3);
        }
        here.step(kTick);
        if (tick % 3 == 0) {
          here.world.move(carts[i], of_cart, here.now_ns, false);
          here.step(kTick / 10);
          here.now_ns -= kTick / 10;
        }
      }
    }
    for (const auto& [pair, story] : moved.heard) {
      ASSERT_EQ(attached.heard[pair].size(), story.size()) << pair;
      for (std::size_t k = 0; k < story.size(); ++k) {
        const Heard& told = attached.heard[pair][k];
        EXPECT_TRUE(told.agrees_with(story[k]))
            << pair << " " << k << ": " << static_cast<int>(told.kind) << " for " << static_cast<int>(story[k].kind)
            << ", in " << told.low_ns - kFirst << " to " << told.high_ns - kFirst << ", expected "
            << story[k].low_ns - kFirst << " to " << story[k].high_ns - kFirst;
      }
    }
    EXPECT_EQ(attached.heard.size(), moved.heard.size());
    EXPECT_GT(moved.heard.size(), 5u);
  }
}

// Attaching tells nothing: what touched goes on to touch.
TEST_F(AttachedObjects, AContactThatHoldsGoesOnOverAttachingAndDetaching) {
  Here here;
  const ObjectId hand = here.add("hand", {0, 0, 1}, kRobot);
  const ObjectId crate = here.add("crate", {0, 0, 0});
  here.add("table", {0, 0, -1}, 0, false);
  here.step();
  here.world.advance(kRobot, here.now_ns + 1);
  here.step();
  EXPECT_EQ(here.heard.size(), 2u);
  here.heard.clear();
  here.step(kTick / 2);  // the publisher is behind the server
  ASSERT_FALSE(here.world.attach(crate, hand));
  here.step();
  here.world.advance(kRobot, kFirst + kTick);
  here.step();
  EXPECT_TRUE(here.heard.empty());
  EXPECT_EQ(here.world.contacts().size(), 2u);
  here.world.detach(crate);
  here.step();
  EXPECT_TRUE(here.heard.empty());
  ASSERT_FALSE(here.world.attach(crate, hand));
  here.step();
  here.world.move(hand, {.position = {0, 0, 5}}, kFirst + 3 * kTick, false);
  here.world.advance(kRobot, kFirst + 3 * kTick);
  here.step(3 * kTick);
  ASSERT_EQ(here.heard["crate table"].size(), 1u);
  EXPECT_EQ(here.heard["crate table"][0].kind, EventKind::ended);
  EXPECT_EQ(here.heard["crate table"][0].reason, EndReason::separated);
  EXPECT_TRUE(here.heard["crate hand"].empty());
}

TEST_F(AttachedObjects, ItEndsWithEitherObjectAndOutlivesANewDefinition) {
  Here here;
  ObjectId hand = here.add("hand", {0, 0, 0}, kRobot);
  const ObjectId crate = here.add("crate", {2, 0, 0});
  here.step();
  ASSERT_FALSE(here.world.attach(crate, hand));
  here.step();
  // Defined anew in one step, as where a publisher claims it: still its parent.
  here.world.remove(hand, EndReason::geometry_changed);
  hand = here.add("hand", {1, 0, 0}, kOther);
  here.step();
  EXPECT_TRUE(here.world.take_ended_attachments().empty());
  EXPECT_LT((here.pose(crate).position - Vec3(3, 0, 0)).norm(), 1e-15);
  EXPECT_EQ(here.world.newest()->parents->at(crate), hand);
  here.world.move(hand, {.position = {5, 0, 0}}, here.now_ns, false);
  here.step();
  EXPECT_LT((here.pose(crate).position - Vec3(7, 0, 0)).norm(), 1e-15);
  // The parent is lost: where its child is now is as unknown.
  here.world.set_stale(hand, true);
  here.step();
  EXPECT_EQ(here.world.newest()->stale_objects.size(), 2u);
  here.world.remove(hand, EndReason::removed);
  here.step();
  const std::vector<EndedAttachment> ended = here.world.take_ended_attachments();
  ASSERT_EQ(ended.size(), 1u);
  EXPECT_EQ(ended[0].child, "crate");
  EXPECT_TRUE(ended[0].is_child_there);
  EXPECT_EQ(here.world.newest()->parents, nullptr);
  EXPECT_TRUE(here.world.newest()->stale_objects.empty());
  EXPECT_LT((here.pose(crate).position - Vec3(7, 0, 0)).norm(), 1e-15);
  hand = here.add("hand", {5, 0, 0}, kRobot);
  here.step();
  ASSERT_FALSE(here.world.attach(crate, hand));
  here.world.remove(crate, EndReason::removed);
  here.step();
  EXPECT_FALSE(here.world.take_ended_attachments().at(0).is_child_there);
  EXPECT_TRUE(here.world.attachments().empty());
}

}  // namespace
}  // namespace collided::engine
