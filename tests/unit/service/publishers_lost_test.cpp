// Publishers that are lost, come back, or are silent.
#include "server/service/ingest/publishers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "server/service/ingest/same_shape.hpp"
#include "tests/studies/bench/clock.hpp"
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

// Poses that an overloaded server merged: the publisher's count grows, and what the object does on that way is marked.
TEST_F(PublishersTest, MergedPosesAreCountedAndTheirWayIsMarked) {
  define(definition(1, 1, "ball", 3));
  define(definition(2, 2, "other", 9));
  PoseSample merged = pose(5, {{1, 4}, {2, 9.5}});
  merged.merged = 2;
  merged.merged_objects = {1, 0};
  merged.source_time_ns = now_ns + 1'000;
  move(merged);
  EXPECT_EQ(publishers.merged_poses(kPublisher), 2U);
  const std::int64_t until = merged.source_time_ns;
  step();
  for (const std::int64_t settled_before : {until - 1, until}) {
    EXPECT_TRUE(publishers.is_merged(*world.find("ball"), settled_before));
    EXPECT_FALSE(publishers.is_merged(*world.find("other"), settled_before)) << "its only pose was applied";
  }
  move(pose(6, {{1, 5}}));
  step();
  EXPECT_TRUE(publishers.is_merged(*world.find("ball"), 0)) << "another publisher may have waited for that way";
  EXPECT_FALSE(publishers.is_merged(*world.find("ball"), until + 1'000'000)) << "that way is decided";
  EXPECT_EQ(publishers.merged_poses(kPublisher), 2U);
}

// What it defined while there was no room for it never came, and its poses waited for ever.
TEST_F(PublishersTest, APublisherWhosePosesLackDefinitionsIsAskedForThem) {
  const auto state = [&] {
    PublisherState found = PublisherState::lost;
    publishers.for_each(now_ns, [&](const PublisherView& view) { found = view.state; });
    return found;
  };
  move(pose(2, {{1, 4}}, 1));
  EXPECT_EQ(state(), PublisherState::alive);
  now_ns += 1'000'000'001;
  EXPECT_EQ(state(), PublisherState::asked);
  define(definition(1, 1, "ball"));
  EXPECT_EQ(state(), PublisherState::alive);
}

// A held object of a publisher that was gone took a place for ever: after four runs of one program nobody could publish.
TEST_F(PublishersTest, PublishersThatAreGoneTakeNoPlaceAndTheOldestAreForgotten) {
  Publishers few(world, {.publishers = 1, .lost_publishers = 2, .object_numbers = 20, .parked_batches = 2});
  const auto run = [&](std::uint64_t publisher, const std::string& name, double z) {
    DefinitionSample sample = definition(1, 1, name, z);
    sample.publisher = publisher;
    sample.lost_policy = static_cast<std::uint8_t>(LostPolicy::hold);
    EXPECT_EQ(few.define(sample, ++now_ns), Applied::done);
    ASSERT_TRUE(world.step(++now_ns, 1, {}));
    few.stepped();
    for (const WriterKind kind : {WriterKind::object, WriterKind::pose}) few.writer_lost(publisher, kind, ++now_ns);
  };
  for (std::uint64_t publisher = 20; publisher < 30; ++publisher)
    run(publisher, "held" + std::to_string(publisher), 3.0 + static_cast<double>(publisher));
  EXPECT_EQ(few.counts().publishers_refused, 0U);
  EXPECT_EQ(few.size(), 2U);
  for (int publisher = 20; publisher < 30; ++publisher)
    EXPECT_TRUE(world.find("held" + std::to_string(publisher))) << "it is held though its publisher is forgotten";
  run(40, "held20", 5);
  EXPECT_EQ(height("held20"), 5) << "an object whose publisher is forgotten gives way like any lost publisher's";
  EXPECT_EQ(few.counts().name_conflicts, 0U);
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

// A program with many objects that starts again: each of its names is looked up once, in whatever order. Equally many names
// are taken over from a publisher that has no others and from one that has 32 times as many, so both rounds touch as much
// memory. Counted is this thread's processor time, of the shortest of some rounds: other programs evict this one's caches.
TEST_F(PublishersTest, TakingOverTheNamesOfALostPublisherTakesAsLongForEach) {
  constexpr std::uint32_t kTimes = 32;
  constexpr std::uint32_t kFew = 625;
  constexpr int kRounds = 5;
  Publishers many(world, {.publishers = 9, .object_numbers = 4 * kTimes * kFew, .parked_batches = 2});
  std::uint64_t publisher = 20;
  const auto take_over = [&](std::uint32_t count, std::uint32_t first, std::uint32_t stride) {
    for (const WriterKind kind : {WriterKind::object, WriterKind::pose}) many.writer_lost(publisher, kind, now_ns);
    ++publisher;
    const double started_s = bench::thread_seconds();
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t ball = first + i * stride;
      DefinitionSample sample = definition(ball, ball + 1, "ball" + std::to_string(ball), 2 + 3 * ball);
      sample.publisher = publisher;
      sample.object_number = publisher % 2 == 0 ? i : count - i;
      sample.lost_policy = static_cast<std::uint8_t>(LostPolicy::freeze);
      EXPECT_EQ(many.define(sample, now_ns), Applied::done);
    }
    const double took_s = bench::thread_seconds() - started_s;
    EXPECT_TRUE(world.step(++now_ns, 1, {}));
    many.stepped();
    return took_s / count;
  };
  double of_few_s = take_over(kFew, 0, 1);
  for (int round = 1; round < kRounds; ++round) of_few_s = std::min(of_few_s, take_over(kFew, 0, 1));
  take_over(kTimes * kFew, 0, 1);
  double of_many_s = take_over(kFew, 0, kTimes);
  for (int round = 1; round < kRounds; ++round) of_many_s = std::min(of_many_s, take_over(kFew, round, kTimes));
  EXPECT_EQ(many.counts().name_conflicts, 0U);
  EXPECT_EQ(many.counts().definitions_applied, (2 * kRounds + kTimes) * kFew);
  std::printf("%.1f and %.1f us a name\n", 1e6 * of_few_s, 1e6 * of_many_s);
  EXPECT_LT(of_many_s, 8 * of_few_s) << "of each; with a walk over all it would be 32 times as long";
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

// Two stages: at first all but what is to be held is where it was, and stale; then it goes by its policy.
TEST_F(PublishersTest, ASilentPublishersObjectsAreStaleBeforeTheyLeave) {
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  Publishers patient(world, {.forget_after_ns = 5 * kSecondNs});
  const auto finish = [&] {
    ASSERT_TRUE(world.step(++now_ns, 1, {}));
    patient.stepped();
  };
  for (const LostPolicy policy : {LostPolicy::remove, LostPolicy::freeze, LostPolicy::hold}) {
    const auto number = static_cast<std::uint32_t>(policy);
    DefinitionSample sample = definition(number, number + 1, "object" + std::to_string(number), 3 + 2 * number);
    sample.lost_policy = static_cast<std::uint8_t>(policy);
    ASSERT_EQ(patient.define(sample, now_ns), Applied::done);
  }
  finish();
  const auto fall_silent = [&] {
    for (const WriterKind kind : {WriterKind::object, WriterKind::pose}) {
      EXPECT_EQ(patient.writer_lost(kPublisher, kind, now_ns), Applied::done);
    }
    finish();
  };
  const auto is_stale = [&](const char* name) { return world.newest()->stale[slot_of(*world.find(name))] != 0; };
  fall_silent();
  const std::vector<std::string> said = patient.take_notices();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_NE(said[0].find("leave by their lost policies in 5 s (--forget-after)"), std::string::npos) << said[0];
  EXPECT_NE(said[0].find("publish with a longer lease"), std::string::npos) << said[0];
  patient.settle(now_ns + 5 * kSecondNs - 1'000);
  finish();
  ASSERT_TRUE(world.find("object0"));
  EXPECT_TRUE(is_stale("object0"));
  EXPECT_TRUE(is_stale("object1"));
  EXPECT_FALSE(is_stale("object2"));
  // A word from it within that time, and nothing has happened.
  PoseSample sample = pose(9, {{0, 4}});
  sample.received_ns = ++now_ns;
  ASSERT_EQ(patient.move(sample, now_ns), Applied::done);
  finish();
  EXPECT_TRUE(world.newest()->stale_objects.empty());
  patient.settle(now_ns + 60 * kSecondNs);
  EXPECT_TRUE(world.find("object0"));
  fall_silent();
  patient.settle(now_ns + 5 * kSecondNs);
  finish();
  EXPECT_FALSE(world.find("object0"));
  EXPECT_TRUE(is_stale("object1"));
}

// What gone publishers have had does not keep a living one from its own: neither numbers nor room in the world.
TEST_F(PublishersTest, GonePublishersObjectsGiveWayWhereThereIsNoRoom) {
  World small{WorldOptions{.max_objects = 4}};
  Publishers few(small, {.publishers = 3, .object_numbers = 4});
  std::uint64_t publisher = 100;
  const auto run = [&](std::uint32_t count) {
    ++publisher;
    for (std::uint32_t number = 0; number < count; ++number) {
      DefinitionSample sample =
          definition(number, number + 1, std::to_string(publisher) + "/" + std::to_string(number));
      sample.publisher = publisher;
      EXPECT_EQ(few.define(sample, ++now_ns), Applied::done);
    }
    EXPECT_TRUE(small.step(++now_ns, 1, {}));
    few.stepped();
    EXPECT_EQ(few.left_out_count(publisher), 0U) << publisher;
    EXPECT_EQ(few.counts().definitions_refused, 0U) << publisher;
    for (const WriterKind kind : {WriterKind::object, WriterKind::pose}) few.writer_lost(publisher, kind, ++now_ns);
  };
  for (int i = 0; i < 5; ++i) run(4);
  for (int i = 0; i < 5; ++i) run(3);
  EXPECT_TRUE(small.find(std::to_string(publisher) + "/2"));
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
  last.flags = wire_contract::kPosesAllSaid;
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
