// What is not known to touch nor to be apart is told, from its beginning to its end, and never taken for apart.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <vector>

#include "server/world/events/contact_ledger.hpp"
#include "server/world/world.hpp"

namespace collided::engine {
namespace {

FoundContact found_pair(ObjectId a, ObjectId b) { return {.a = a, .b = b, .contact = {}}; }

void end_unfound(ContactLedger& ledger) {
  constexpr std::uint32_t kSlots[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  ledger.end_unfound(kSlots, [](const OpenContact&) { return ContactEnd{.reason = EndReason::separated}; });
}

TEST(Doubt, IsToldFromItsBeginningToItsEnd) {
  ContactLedger ledger;
  ledger.begin_step(1'000, false);
  ledger.doubts(found_pair(1, 2), Doubt::numeric);
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 1u);
  EXPECT_EQ(ledger.events()[0].kind, EventKind::began);
  EXPECT_EQ(ledger.events()[0].of.doubt, Doubt::numeric);
  EXPECT_TRUE(std::isinf(ledger.events()[0].of.contact.depth_error_m)) << "nothing is known of its depth";
  EXPECT_FALSE(ledger.holds(1, 2)) << "a doubt is no contact";
  EXPECT_EQ(ledger.doubt_count(), 1u);

  ledger.begin_step(2'000, false);
  ledger.doubts(found_pair(1, 2), Doubt::numeric);
  end_unfound(ledger);
  ledger.finish_step();
  EXPECT_TRUE(ledger.events().empty()) << "it goes on";

  ledger.begin_step(3'000, false);
  end_unfound(ledger);
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 1u);
  EXPECT_EQ(ledger.events()[0].reason, EndReason::decided);
  EXPECT_EQ(ledger.events()[0].of.episode, 1u);
  EXPECT_EQ(ledger.doubt_count(), 0u);
}

TEST(Doubt, EndsBeforeTheContactThatItTurnsOutToBe) {
  ContactLedger ledger;
  ledger.begin_step(1'000, false);
  ledger.doubts(found_pair(1, 2), Doubt::numeric);
  ledger.finish_step();
  ledger.begin_step(2'000, false);
  ledger.touches(found_pair(1, 2));
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 2u);
  EXPECT_EQ(ledger.events()[0].kind, EventKind::ended);
  EXPECT_EQ(ledger.events()[0].reason, EndReason::decided);
  EXPECT_EQ(ledger.events()[0].of.episode, 1u);
  EXPECT_EQ(ledger.events()[1].kind, EventKind::began);
  EXPECT_EQ(ledger.events()[1].of.doubt, Doubt::none);
  EXPECT_EQ(ledger.events()[1].of.episode, 3u);
  EXPECT_TRUE(ledger.holds(1, 2));
}

TEST(Doubt, DoesNotEndWhatHolds) {
  ContactLedger ledger;
  ledger.begin_step(1'000, false);
  ledger.touches(found_pair(1, 2));
  ledger.finish_step();
  ledger.begin_step(2'000, false);
  ledger.doubts(found_pair(1, 2), Doubt::numeric);
  end_unfound(ledger);
  ledger.finish_step();
  EXPECT_TRUE(ledger.events().empty());
  EXPECT_TRUE(ledger.holds(1, 2));
}

TEST(Doubt, EndsWithItsObject) {
  ContactLedger ledger;
  ledger.begin_step(1'000, false);
  ledger.doubts(found_pair(1, 2), Doubt::cost_limit);
  ledger.finish_step();
  ledger.begin_step(2'000, false);
  ledger.end_object(2, EndReason::removed);
  ledger.finish_step();
  ASSERT_EQ(ledger.events().size(), 1u);
  EXPECT_EQ(ledger.events()[0].reason, EndReason::removed);
  EXPECT_EQ(ledger.doubt_count(), 0u);
}

/// 2 x 2 m of squares of two triangles each.
Shape sheet(std::uint32_t squares) {
  auto mesh = std::make_shared<TriangleMesh>();
  for (std::uint32_t y = 0; y <= squares; ++y) {
    for (std::uint32_t x = 0; x <= squares; ++x)
      mesh->vertices.push_back(Vec3(2.0 * x / squares - 1, 2.0 * y / squares - 1, 0));
  }
  for (std::uint32_t y = 0; y < squares; ++y) {
    for (std::uint32_t x = 0; x < squares; ++x) {
      const std::uint32_t at = y * (squares + 1) + x;
      mesh->triangles.push_back({at, at + 1, at + squares + 1});
      mesh->triangles.push_back({at + 1, at + squares + 2, at + squares + 1});
    }
  }
  Shape shape;
  shape.mesh = mesh;
  return shape;
}

// A tenth of a millimetre apart all the way while one turns, but there are too many triangles to look at them all.
TEST(Doubt, AWayThatCannotBeFollowedToItsEndIsTold) {
  constexpr std::int64_t kStart = 1'000'000'000'000;
  World world{WorldOptions{}};
  std::vector<ObjectId> ids;
  for (const std::uint64_t publisher : {1, 2}) {
    ObjectDefinition definition;
    definition.name = "sheet " + std::to_string(publisher);
    definition.shape = sheet(60);
    definition.publisher = publisher;
    definition.pose.position = {0, 0, publisher == 1 ? 0 : 1e-4};
    ids.push_back(std::get<ObjectId>(world.define(definition)));
    world.advance(publisher, kStart);
  }
  ASSERT_TRUE(world.step(kStart, 1, {}));
  ASSERT_TRUE(world.events().empty());
  const Quat turned(Eigen::AngleAxisd(1, Vec3::UnitZ()));
  ASSERT_TRUE(world.move(ids[1], {.position = {0.7, 0.3, 1e-4}, .rotation = turned}, kStart + 10'000'000, false));
  for (const std::uint64_t publisher : {1, 2}) world.advance(publisher, kStart + 10'000'000);
  ASSERT_TRUE(world.step(kStart + 10'000'000, 1, {}));
  ASSERT_EQ(world.events().size(), 2u);
  const Event& began = world.events()[0];
  EXPECT_EQ(began.kind, EventKind::began);
  EXPECT_EQ(began.of.doubt, Doubt::cost_limit);
  EXPECT_DOUBLE_EQ(began.bracket_low_s, 0.01);
  EXPECT_EQ(world.events()[1].reason, EndReason::decided) << "where it has come to is known to be apart";
  EXPECT_TRUE(world.contacts().empty());
  EXPECT_EQ(world.doubt_count(), 0u);
}

// Frozen where its publisher said last, it may have gone on: it is not known to touch what stands there, nor to have left it.
TEST(Doubt, WhateverTouchesALostPublishersObjectIsInDoubtUntilItIsFoundAgain) {
  constexpr std::int64_t kStart = 1'000'000'000'000;
  constexpr std::int64_t kTick = 10'000'000;
  World world{WorldOptions{}};
  const auto ball = [&](const char* name, std::uint64_t publisher, double x) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = 1}};
    definition.publisher = publisher;
    definition.pose.position = {x, 0, 0};
    return std::get<ObjectId>(world.define(definition));
  };
  std::int64_t now_ns = kStart;
  const auto step = [&](std::vector<std::pair<ObjectId, double>> moves) {
    now_ns += kTick;
    for (const auto& [id, x] : moves)
      world.move(id, {.position = {x, 0, 0}, .rotation = Quat::Identity()}, now_ns, false);
    for (const std::uint64_t publisher : {1, 2}) world.advance(publisher, now_ns);
    EXPECT_TRUE(world.step(now_ns, 1, {}));
    std::vector<std::tuple<EventKind, Doubt, EndReason>> told;
    for (const Event& event : world.events()) told.emplace_back(event.kind, event.of.doubt, event.reason);
    return told;
  };
  using Told = decltype(step({}));
  const Told kNothing;
  const ObjectId lost = ball("lost", 1, 0);
  const ObjectId near = ball("near", 2, 1.5);
  const ObjectId other = ball("other", 2, -9);
  EXPECT_EQ(step({{lost, 0}, {near, 1.5}, {other, -9}}), Told({{EventKind::began, Doubt::none, EndReason::none}}));
  world.set_stale(lost, true);
  world.lose(1);
  EXPECT_EQ(step({}), Told({{EventKind::ended, Doubt::none, EndReason::publisher_lost},
                            {EventKind::began, Doubt::publisher_lost, EndReason::none}}));
  EXPECT_EQ(world.doubt_count(), 1u);
  EXPECT_EQ(step({{near, 4}}), kNothing) << "who knows what it has left";
  EXPECT_EQ(world.doubt_count(), 1u);
  EXPECT_EQ(step({{other, -1.5}}), Told({{EventKind::began, Doubt::publisher_lost, EndReason::none}}));
  EXPECT_EQ(step({{other, -1.6}}), kNothing);
  EXPECT_EQ(world.doubt_count(), 2u);
  world.set_stale(lost, false);
  EXPECT_EQ(step({}), Told({{EventKind::ended, Doubt::publisher_lost, EndReason::decided},
                            {EventKind::ended, Doubt::publisher_lost, EndReason::decided},
                            {EventKind::began, Doubt::none, EndReason::none}}))
      << "nobody has moved since, and now it is known";
  EXPECT_EQ(world.doubt_count(), 0u);
  EXPECT_EQ(step({{lost, 3}}), Told({{EventKind::ended, Doubt::none, EndReason::separated},
                                     {EventKind::began, Doubt::none, EndReason::none}}));
  world.set_stale(lost, true);
  EXPECT_EQ(step({}).size(), 2u);
  EXPECT_EQ(world.doubt_count(), 1u);
  world.remove(lost, EndReason::removed);
  EXPECT_EQ(step({}), Told({{EventKind::ended, Doubt::publisher_lost, EndReason::removed}}));
  EXPECT_EQ(world.doubt_count(), 0u);
}

}  // namespace
}  // namespace collided::engine
