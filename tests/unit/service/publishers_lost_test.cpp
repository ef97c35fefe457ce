// Publishers that are lost, come back, or are silent.
#include "server/service/ingest/publishers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>

#include "server/service/ingest/same_shape.hpp"
#include "tests/unit/service/publishers_fixture.hpp"

namespace collided::engine::service {
namespace {

TEST_F(PublishersTest, ALostPublishersObjectGivesWay) {
  DefinitionSample frozen = definition(1, 1, "arm");
  frozen.lost_policy = static_cast<std::uint8_t>(LostPolicy::freeze);
  define(frozen);
  step();
  lose();
  DefinitionSample again = definition(1, 1, "arm", 5);
  again.publisher = 8;
  define(again);
  step();
  EXPECT_EQ(height("arm"), 5);
}

// What is defined again just as it is in the world stays there, with what it touches; anything else is another object.
TEST_F(PublishersTest, DefinedAgainAsItIsItStays) {
  define(definition(1, 1, "ball", 0.25));
  step();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].kind, EventKind::began);
  const ObjectId id = *world.find("ball");
  define(definition(1, 2, "ball", 0.25));
  step();
  EXPECT_EQ(world.find("ball"), id);
  EXPECT_EQ(events.size(), 1U);
  EXPECT_EQ(publishers.counts().definitions_applied, 2U);
  move(pose(3, {{1, 0.375}}));
  step();
  define(definition(1, 4, "ball", 0.375));  // with the newest pose, as libraries do
  step();
  EXPECT_EQ(events.size(), 1U);

  std::uint64_t sequence = 5;
  const auto changes = [&](const std::function<void(DefinitionSample&)>& change) {
    const ObjectId before = *world.find("ball");
    DefinitionSample other = definition(1, sequence++, "ball", 0.375);
    change(other);
    define(other);
    step();
    const bool is_another = world.find("ball") != before;
    define(definition(1, sequence++, "ball", 0.375));
    step();
    return is_another;
  };
  EXPECT_TRUE(changes([](DefinitionSample& s) { s.pose[2] = 0.376; }));
  EXPECT_TRUE(changes([](DefinitionSample& s) { s.pose[3] = 0.6, s.pose[6] = 0.8; }));
  EXPECT_TRUE(changes([](DefinitionSample& s) { s.filter.layers = 2; }));
  EXPECT_TRUE(changes([](DefinitionSample& s) { s.filter.group = 2; }));
  EXPECT_TRUE(changes([](DefinitionSample& s) { s.moving = false; }));
  EXPECT_TRUE(changes([](DefinitionSample& s) { s.lost_policy = 1; }));
  const auto with = [&](const Primitive& primitive) {
    return changes([&](DefinitionSample& s) { s.shape = Shape{{primitive}, nullptr}; });
  };
  EXPECT_TRUE(with(Sphere{.center = Vec3::Zero(), .radius_m = 0.5000000000000001}));
  EXPECT_TRUE(with(Sphere{.center = {0, 0x1p-1000, 0}, .radius_m = 0.5}));
  EXPECT_TRUE(with(Box{.center = Vec3::Zero(), .half_m = Vec3::Constant(0.5)}));
  EXPECT_FALSE(with(Sphere{.center = Vec3::Zero(), .radius_m = 0.5}));
  EXPECT_TRUE(changes([](DefinitionSample& s) { std::get<Shape>(s.shape).primitives.emplace_back(Sphere{}); }));
}

TEST_F(PublishersTest, AnObjectThatACommandRemovedComesBackWhenItIsDefinedAgain) {
  define(definition(1, 1, "ball"));
  step();
  ASSERT_TRUE(world.remove(*world.find("ball"), EndReason::removed));
  step();
  define(definition(1, 2, "ball"));
  step();
  EXPECT_TRUE(world.find("ball"));
}

TEST_F(PublishersTest, WhatACommandMovedMeanwhileIsPutBackWhereItIsDefined) {
  define(definition(1, 1, "ball", 3));
  step();
  for (const bool is_stepped : {true, false}) {
    ASSERT_TRUE(world.move(*world.find("ball"), {.position = {0, 0, 7}}, ++now_ns, true));
    if (is_stepped) step();
    define(definition(1, is_stepped ? 2 : 3, "ball", 3));
    step();
    EXPECT_EQ(height("ball"), 3) << is_stepped;
  }
}

// A refused definition leaves the object as it was and says so until a good one comes.
TEST_F(PublishersTest, ARefusalIsOverWhenTheObjectIsDefinedAgainAsItIs) {
  define(definition(1, 1, "ball"));
  step();
  DefinitionSample bad = definition(1, 2, "ball");
  bad.shape = Refusal{"it is bad"};
  define(bad);
  EXPECT_EQ(publishers.left_out(kPublisher, 9).size(), 1U);
  define(definition(1, 3, "ball"));
  EXPECT_EQ(publishers.left_out(kPublisher, 9).size(), 0U);
}

// Its contact ends and begins once each, although the publisher defines everything again when it hears of its loss.
TEST_F(PublishersTest, WhoIsBackAndDefinesEverythingAgainIsBackOnce) {
  define(definition(1, 1, "ball", 0.25));
  step();
  lose();
  step();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[1].reason, EndReason::publisher_lost);
  PoseSample alive = pose(2, {});
  alive.sequence = 0;
  move(alive);
  step();
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[2].kind, EventKind::began);
  define(definition(1, 3, "ball", 0.25));
  step();
  EXPECT_EQ(events.size(), 3U);
}

TEST(SameShape, EveryKindIsItselfAndNothingElse) {
  const auto mesh = [](double x) {
    TriangleMesh made;
    made.vertices = {{x, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    made.triangles = {{0, 1, 2}};
    return std::make_shared<const TriangleMesh>(made);
  };
  std::vector<Shape> shapes;
  const auto primitive = [&](const Primitive& one) { shapes.push_back({{one}, nullptr}); };
  for (const double r : {1.0, 2.0}) {
    const Vec3 p(r, 2, 3), q(4, 5, 6);
    const Mat3 turned = Quat(1, 0, 0, r).normalized().toRotationMatrix();
    primitive(Sphere{.center = p, .radius_m = 1});
    primitive(Sphere{.center = q, .radius_m = r});
    primitive(Box{.center = p, .half_m = q});
    primitive(Box{.center = q, .axes = turned, .half_m = q});
    primitive(Box{.center = q, .half_m = p});
    primitive(Capsule{.a = p, .b = q, .radius_m = 1});
    primitive(Capsule{.a = q, .b = p, .radius_m = 1});
    primitive(Capsule{.a = q, .b = q, .radius_m = r});
    primitive(Cylinder{.a = p, .b = q, .radius_m = 1});
    primitive(Cylinder{.a = q, .b = p, .radius_m = 1});
    primitive(Cylinder{.a = q, .b = q, .radius_m = r});
    primitive(Cone{.apex = p, .base = q, .radius_m = 1});
    primitive(Cone{.apex = q, .base = p, .radius_m = 1});
    primitive(Cone{.apex = q, .base = q, .radius_m = r});
    primitive(Ellipsoid{.center = p, .half_m = q});
    primitive(Ellipsoid{.center = q, .axes = turned, .half_m = q});
    primitive(Ellipsoid{.center = q, .half_m = p});
    primitive(Hull{.mesh = mesh(r), .position = q});
    primitive(Hull{.mesh = mesh(7), .rotation = turned, .position = q});
    primitive(Hull{.mesh = mesh(7), .position = p});
    primitive(HalfSpace{.point = p, .normal = q});
    primitive(HalfSpace{.point = q, .normal = p});
    shapes.push_back({{}, mesh(r + 10)});
    shapes.push_back({{Sphere{.center = p, .radius_m = 1}, Sphere{.center = q, .radius_m = 1}}, mesh(20)});
  }
  shapes.push_back({{}, nullptr});
  const std::vector<Shape> copies = shapes;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t k = 0; k < copies.size(); ++k)
      EXPECT_EQ(is_same_shape(shapes[i], copies[k]), i == k) << i << " " << k;
  }
}

// A program with many objects that starts again: each of its names is looked up once, in whatever order.
TEST_F(PublishersTest, TakingOverTheNamesOfALostPublisherTakesAsLongForEach) {
  constexpr std::uint32_t kMost = 20'000;
  Publishers many(world, {.publishers = 9, .object_numbers = 4 * kMost, .parked_batches = 2});
  std::uint64_t publisher = 20;
  const auto take_over = [&](std::uint32_t count) {
    for (const WriterKind kind : {WriterKind::object, WriterKind::pose}) many.writer_lost(publisher, kind, now_ns);
    ++publisher;
    const auto started = std::chrono::steady_clock::now();
    for (std::uint32_t i = 0; i < count; ++i) {
      DefinitionSample sample = definition(i, i + 1, "ball" + std::to_string(i), 2 + 3 * i);
      sample.publisher = publisher;
      sample.object_number = publisher % 2 == 0 ? i : count - i;
      sample.lost_policy = static_cast<std::uint8_t>(LostPolicy::freeze);
      EXPECT_EQ(many.define(sample, now_ns), Applied::done);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - started;
    EXPECT_TRUE(world.step(++now_ns, 1, {}));
    many.stepped();
    return took.count() / count;
  };
  double few_s = take_over(kMost / 32);
  for (int round = 0; round < 3; ++round) few_s = std::min(few_s, take_over(kMost / 32));
  take_over(kMost);
  const double many_s = std::min(take_over(kMost), take_over(kMost));
  EXPECT_EQ(many.counts().name_conflicts, 0U);
  EXPECT_EQ(many.counts().definitions_applied, 4 * kMost / 32 + 3 * kMost);
  std::printf("%.1f and %.1f us a name\n", 1e6 * few_s, 1e6 * many_s);
  EXPECT_LT(many_s, 8 * few_s) << "of each; with a walk over all it would be 32 times as long";
}

TEST_F(PublishersTest, EachPolicyForTheLost) {
  for (const LostPolicy policy : {LostPolicy::remove, LostPolicy::freeze, LostPolicy::hold}) {
    const auto number = static_cast<std::uint32_t>(policy);
    DefinitionSample sample = definition(number, number + 1, "object" + std::to_string(number), 3 + 2 * number);
    sample.lost_policy = static_cast<std::uint8_t>(policy);
    define(sample);
  }
  step();
  lose();
  step();
  EXPECT_FALSE(publishers.is_live(kPublisher));
  EXPECT_FALSE(world.find("object0"));
  EXPECT_EQ(world.newest()->stale[slot_of(*world.find("object1"))], 1);
  EXPECT_EQ(world.newest()->stale[slot_of(*world.find("object2"))], 0);
  move(pose(9, {{0, 4}}));  // a word from it: it is back, with everything
  step();
  EXPECT_TRUE(publishers.is_live(kPublisher));
  EXPECT_EQ(height("object0"), 4);
  EXPECT_TRUE(world.newest()->stale_objects.empty());
}

TEST_F(PublishersTest, OneOfTwoWritersIsEnoughToLive) {
  define(definition(1, 1, "ball"));
  move(pose(2, {{1, 2}}));
  step();
  EXPECT_EQ(publishers.writer_lost(kPublisher, WriterKind::object, now_ns), Applied::done);
  EXPECT_TRUE(publishers.is_live(kPublisher));
  EXPECT_EQ(publishers.writer_lost(kPublisher, WriterKind::pose, now_ns), Applied::done);
  EXPECT_FALSE(publishers.is_live(kPublisher));
}

TEST_F(PublishersTest, StatesAreShown) {
  define(definition(1, 1, "ball"));
  step();
  const auto state = [&](std::int64_t at_ns) {
    PublisherState shown = PublisherState::lost;
    publishers.for_each(at_ns, [&](const PublisherView& view) { shown = view.state; });
    return shown;
  };
  EXPECT_EQ(state(now_ns), PublisherState::alive);
  EXPECT_EQ(state(now_ns + 3'000'000'000), PublisherState::silent);
  lose();
  EXPECT_EQ(state(now_ns), PublisherState::lost);
  publishers.settle(now_ns + 61'000'000'000);
  EXPECT_EQ(publishers.size(), 0U);
}

TEST_F(PublishersTest, WhoIsLostWithAnObjectIsShownUntilItIsForgotten) {
  define(definition(1, 1, "ball"));
  step();
  lose();
  const auto shown = [&] {
    std::vector<PublisherState> states;
    publishers.for_each(now_ns, [&](const PublisherView& view) { states.push_back(view.state); });
    return states;
  };
  EXPECT_EQ(shown(), std::vector<PublisherState>{PublisherState::lost});
  publishers.settle(now_ns + 61'000'000'000);
  EXPECT_TRUE(shown().empty());
}

TEST_F(PublishersTest, WhoTookEverythingBackIsNoLoss) {
  define(definition(1, 1, "ball"));
  define(removal(1, 2));
  step();
  lose();
  int shown = 0;
  publishers.for_each(now_ns, [&](const PublisherView&) { ++shown; });
  EXPECT_EQ(shown, 0);
  EXPECT_EQ(publishers.applied_through(kPublisher), 2U) << "somebody may still ask after its last write";
}

// Nobody stands behind what a dead program wanted to add: the name stays free until that program is back.
TEST_F(PublishersTest, WhatALostPublisherWaitedToAddDoesNotTakeTheNameThatBecameFree) {
  define(definition(1, 1, "ball"));
  DefinitionSample second = definition(1, 1, "ball", 5);
  second.publisher = 8;
  define(second);
  step();
  for (const WriterKind kind : {WriterKind::object, WriterKind::pose}) {
    ASSERT_EQ(publishers.writer_lost(8, kind, now_ns), Applied::done);
  }
  define(removal(1, 2));
  publishers.settle(now_ns);
  step();
  EXPECT_FALSE(world.find("ball"));
  publishers.writer_alive(8, WriterKind::object, now_ns);
  publishers.settle(now_ns);
  step();
  EXPECT_EQ(height("ball"), 5);
}

// Each pose replaces the velocity of the one before, also by none.

TEST_F(PublishersTest, AWriterThatComesBackMakesItsObjectsFreshAgain) {
  for (const LostPolicy policy : {LostPolicy::remove, LostPolicy::freeze, LostPolicy::hold}) {
    const auto number = static_cast<std::uint32_t>(policy);
    DefinitionSample sample = definition(number, number + 1, "object" + std::to_string(number), 3 + 2 * number);
    sample.lost_policy = static_cast<std::uint8_t>(policy);
    define(sample);
  }
  for (const WriterKind kind : {WriterKind::object, WriterKind::pose}) {
    step();
    lose();
    step();
    EXPECT_FALSE(publishers.is_live(kPublisher));
    EXPECT_EQ(world.newest()->stale_objects.size(), 1U);
    publishers.take_changes();
    publishers.writer_alive(kPublisher, kind, now_ns);
    EXPECT_GT(publishers.take_changes(), 0U) << "the world is another one: it must step";
    step();
    EXPECT_TRUE(publishers.is_live(kPublisher));
    EXPECT_TRUE(world.newest()->stale_objects.empty());
    EXPECT_EQ(world.newest()->stale[slot_of(*world.find("object1"))], 0);
    EXPECT_EQ(height("object0"), 3);
    EXPECT_EQ(height("object2"), 7);
  }
}

// Either writer may be the one that is heard again: the other one's end is then no loss.
TEST_F(PublishersTest, AWriterThatIsBackCountsAsAlive) {
  define(definition(1, 1, "ball"));
  move(pose(2, {{1, 2}}));
  step();
  ASSERT_EQ(publishers.writer_lost(kPublisher, WriterKind::pose, now_ns), Applied::done);
  publishers.writer_alive(kPublisher, WriterKind::pose, now_ns);
  ASSERT_EQ(publishers.writer_lost(kPublisher, WriterKind::object, now_ns), Applied::done);
  EXPECT_TRUE(publishers.is_live(kPublisher));
  publishers.writer_alive(kPublisher, WriterKind::object, now_ns);
  ASSERT_EQ(publishers.writer_lost(kPublisher, WriterKind::pose, now_ns), Applied::done);
  EXPECT_TRUE(publishers.is_live(kPublisher));
  ASSERT_EQ(publishers.writer_lost(kPublisher, WriterKind::object, now_ns), Applied::done);
  EXPECT_FALSE(publishers.is_live(kPublisher));
}

// What waits is dropped from its old end; what is applied at last is the newest of what was kept, in order.

TEST_F(PublishersTest, APublisherIsCompleteOnceItHasSaidSoAndNoLongerOnceItIsLost) {
  define(definition(1, 1, "ball"));
  move(pose(2, {{1, 2}}));
  EXPECT_FALSE(publishers.is_complete(kPublisher));
  PoseSample last = pose(3, {{1, 2}});
  last.flags = wire_contract::kAllSaid;
  move(last);
  step();
  EXPECT_TRUE(publishers.is_complete(kPublisher));
  lose();
  step();
  EXPECT_FALSE(publishers.is_complete(kPublisher));
  DefinitionSample again = definition(1, 1, "ball");
  again.incarnation = 2;
  define(again);
  EXPECT_FALSE(publishers.is_complete(kPublisher)) << "its new life has yet to say all";
}

}  // namespace
}  // namespace collided::engine::service
