// Publishers that are lost, come back, or are silent.
#include "server/service/ingest/publishers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>

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
