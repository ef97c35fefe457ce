// Objects that move along with others, beside the same objects moved by the publisher itself.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "server/world/fences/fences.hpp"
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
    World world{WorldOptions{.memory = {.reach_ns = 60'000'000'000}}};
    HeardOfPairs heard;
    std::int64_t now_ns = kFirst;

    ObjectId add(const std::string& name, const Vec3& place, std::uint64_t publisher = 0, bool moving = true,
                 double half_m = 0.5) {
      return add(name, Box{.center = Vec3::Zero(), .half_m = Vec3::Constant(half_m)}, place, publisher, moving);
    }
    ObjectId add(const std::string& name, const Primitive& shape, const Vec3& place, std::uint64_t publisher = 0,
                 bool moving = true) {
      return add(name, std::vector<Primitive>{shape}, place, publisher, moving);
    }
    ObjectId add(const std::string& name, const std::vector<Primitive>& parts, const Vec3& place,
                 std::uint64_t publisher, bool moving) {
      ObjectDefinition object;
      object.name = name;
      for (const Primitive& part : parts) object.shape.primitives.emplace_back(part);
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

// At a fixed place of its parent: the judge is an object with the same shape in the parent's frame, at the parent's poses.
// Contacts between two poses are reported within the same brackets. Every other child is a ball.
TEST_F(AttachedObjects, EventsAreThoseOfAPartOfTheParentsShape) {
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
      const Vec3 place(2, 0.5, 0);
      const Vec3 center = here == &moved ? place : Vec3::Zero();
      std::vector<Primitive> parts{Box{.center = center, .half_m = Vec3::Constant(0.5)}};
      if (round % 2 == 1) parts = {Sphere{.center = center, .radius_m = 0.6}};
      // The centre of an object that is one sphere goes straight; as a part of a shape it does not.
      if (round % 2 == 1 && here == &moved) parts.emplace_back(Sphere{.center = center, .radius_m = 0.1});
      crates.push_back(here->add("crate", parts, place - center, here == &moved ? kRobot : 0, true));
      for (const std::uint64_t publisher : {kRobot, kOther}) here->world.advance(publisher, kFirst);
      here->step();
    }
    ASSERT_FALSE(attached.world.attach(crates[0], hands[0]));
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
          poses.push_back(of_hand);
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

// A quarter turn in a second: what is attached 1 m off goes along the arc, and so does what is attached to that.
TEST_F(AttachedObjects, BetweenTwoPosesItGoesAlongTheArcOfItsParent) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const auto on_arc = [](double radius_m, double share) {
    return Vec3(radius_m * std::cos(share * M_PI / 2), radius_m * std::sin(share * M_PI / 2), 0);
  };
  for (const bool streamed : {false, true}) {
    Here here;
    const auto ball = [](double radius_m) { return Sphere{.center = Vec3::Zero(), .radius_m = radius_m}; };
    const ObjectId parent = here.add("parent", ball(0.01), {0, 0, 0}, kRobot);
    const ObjectId child = here.add("child", ball(0.05), {1, 0, 0});
    const ObjectId tip = here.add("tip", ball(0.05), {2, 0, 0});
    here.add("on the arc", ball(0.05), on_arc(1, 0.5), 0, false);
    here.add("on the chord", ball(0.05), {0.5, 0.5, 0}, 0, false);
    here.add("tip's", ball(0.05), on_arc(2, 0.25), 0, false);
    here.add("beside", ball(0.05), on_arc(2, 0.25) * 1.04, kOther);
    for (const std::uint64_t publisher : {kRobot, kOther}) here.world.advance(publisher, here.now_ns);
    here.step();
    ASSERT_FALSE(here.world.attach(tip, child));
    ASSERT_FALSE(here.world.attach(child, parent));
    here.step();
    here.heard.clear();
    const std::int64_t start_ns = kFirst + kSecond;
    for (const double angle : {0.0, M_PI / 2}) {
      const std::int64_t time_ns = angle == 0 ? start_ns : start_ns + kSecond;
      const Pose pose{.position = Vec3::Zero(), .rotation = Quat(std::cos(angle / 2), 0, 0, std::sin(angle / 2))};
      bool done = false;
      here.world.move(std::span(&parent, 1), std::span(&pose, 1), time_ns, false, std::span(&done, 1), streamed);
      for (const std::uint64_t publisher : {kRobot, kOther}) here.world.advance(publisher, time_ns);
      here.step(kSecond);
    }
    here.step(kSecond);
    std::vector<std::string> pairs;
    for (const auto& [pair, story] : here.heard) pairs.push_back(pair);
    EXPECT_EQ(pairs, (std::vector<std::string>{"beside tip", "child on the arc", "tip tip's"}));
    const std::vector<Heard>& story = here.heard["child on the arc"];
    ASSERT_EQ(story.size(), 2u);
    // The centres are 0.1 m apart where the angle to the middle is 2 asin(0.05).
    const double half_s = 2 * std::asin(0.05) / (M_PI / 2);
    EXPECT_LE(story[0].low_ns, start_ns + std::llround(1e9 * (0.5 - half_s)));
    EXPECT_GE(story[0].high_ns, start_ns + std::llround(1e9 * (0.5 - half_s)));
    for (const double share : {0.125, 0.25, 0.5, 0.75}) {
      const auto state = here.world.memory().at(start_ns + std::llround(share * 1e9));
      ASSERT_NE(state, nullptr);
      EXPECT_LT((state->poses[slot_of(child)].position - on_arc(1, share)).norm(), 1e-12) << share;
      EXPECT_LT((state->poses[slot_of(tip)].position - on_arc(2, share)).norm(), 1e-12) << share;
    }
  }
}

// And what is about it: a fence that an attached object carries.
TEST_F(AttachedObjects, AFenceAboutWhatIsAttachedGoesAlongTheArc) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  for (const bool is_in_step : {false, true}) {
    Here here;
    const auto ball = [](double radius_m) { return Sphere{.center = Vec3::Zero(), .radius_m = radius_m}; };
    const std::uint64_t other = is_in_step ? kRobot : kOther;
    const ObjectId parent = here.add("parent", ball(0.01), {0, 0, 0}, kRobot);
    const ObjectId child = here.add("child", ball(0.01), {1, 0, 0});
    here.add("on the arc", ball(0.05), {std::sqrt(0.5), std::sqrt(0.5), 0}, other);
    here.add("on the chord", ball(0.05), {0.5, 0.5, 0}, other);
    FenceDefinition fence{.name = "zone", .carrier = "child"};
    fence.shape.primitives.emplace_back(ball(0.05));
    ASSERT_TRUE(std::holds_alternative<ObjectId>(here.world.add_fence(fence)));
    for (const std::uint64_t publisher : {kRobot, kOther}) here.world.advance(publisher, here.now_ns);
    here.step();
    ASSERT_FALSE(here.world.attach(child, parent));
    here.step();
    std::vector<std::string> said;
    for (const double angle : {0.0, M_PI / 2}) {
      const std::int64_t time_ns = kFirst + (angle == 0 ? 1 : 2) * kSecond;
      here.world.move(parent, {.rotation = Quat(std::cos(angle / 2), 0, 0, std::sin(angle / 2))}, time_ns, false);
      for (const std::uint64_t publisher : {kRobot, kOther}) here.world.advance(publisher, time_ns);
      here.step(kSecond);
      for (const Event& event : here.world.fences()->events()) {
        const ObjectInfo* const info = here.world.info(event.of.a);
        ASSERT_NE(info, nullptr);
        said.push_back((event.kind == EventKind::began ? "in " : "out ") + info->name);
      }
    }
    EXPECT_EQ(said, (std::vector<std::string>{"in on the arc", "out on the arc"})) << is_in_step;
  }
}

// Detached, it goes straight again; what the memory has of the time before stays.
TEST_F(AttachedObjects, TheArcEndsWithTheAttachment) {
  Here here;
  const ObjectId parent = here.add("parent", {0, 0, 0}, kRobot);
  const ObjectId child = here.add("child", Sphere{.center = Vec3::Zero(), .radius_m = 0.05}, {3, 0, 0});
  here.world.advance(kRobot, here.now_ns);
  here.step();
  ASSERT_FALSE(here.world.attach(child, parent));
  here.step();
  const Quat half(0, 0, 0, 1), quarter(std::sqrt(0.5), 0, 0, std::sqrt(0.5));
  const std::int64_t start_ns = kFirst + 100 * kTick;
  std::int64_t time_ns = start_ns;
  for (const Quat& rotation : {Quat(1, 0, 0, 0), quarter}) {
    here.world.move(parent, {.position = Vec3::Zero(), .rotation = rotation}, time_ns, false);
    here.world.advance(kRobot, time_ns);
    here.step(100 * kTick);
    time_ns += 100 * kTick;
  }
  ASSERT_TRUE(here.world.detach(child));
  here.step(10 * kTick);
  const std::int64_t released_ns = here.now_ns;
  here.world.move(child, {.position = {3, 0, 0}, .rotation = half}, released_ns + 100 * kTick, false);
  here.step(200 * kTick);
  const auto at = [&](std::int64_t when_ns) { return here.world.memory().at(when_ns)->poses[slot_of(child)].position; };
  EXPECT_LT((at(start_ns + 50 * kTick) - 3 * Vec3(std::sqrt(0.5), std::sqrt(0.5), 0)).norm(), 1e-12);
  const Vec3 between = at(released_ns + 50 * kTick);
  EXPECT_LT((between - Vec3(between.x(), 3 - between.x(), 0)).norm(), 1e-12) << "on the line from (0, 3) to (3, 0)";
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
