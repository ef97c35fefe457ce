// Questions about one instant: each object where its publisher's poses put it then.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kMemorySecond = 1'000'000'000;
constexpr std::int64_t kMemoryStart = 1'000 * kMemorySecond;
constexpr std::int64_t kTick = 10'000'000;

Pose at(double x, double y = 0, double z = 0) { return {.position = {x, y, z}}; }

class WorldPoseMemory : public testing::Test {
 protected:
  ObjectId ball(const std::string& name, std::uint64_t publisher, const Pose& pose, double radius_m = 0.5) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = radius_m}};
    definition.pose = pose;
    definition.publisher = publisher;
    definition.moving = publisher != 0;
    return std::get<ObjectId>(world.define(definition));
  }
  void say(std::uint64_t publisher, std::int64_t time_ns, const std::map<ObjectId, Pose>& poses,
           bool teleport = false) {
    for (const auto& [id, pose] : poses) ASSERT_TRUE(world.move(id, pose, time_ns, teleport));
    world.advance(publisher, time_ns);
    now_ns = std::max(now_ns, time_ns);
    ASSERT_TRUE(world.step(now_ns, 1, {}));
  }
  Vec3 place(std::int64_t time_ns, ObjectId id) const {
    const std::shared_ptr<const Snapshot> state = world.memory().at(time_ns);
    return state ? state->frames.at(slot_of(id)).position : Vec3::Constant(NAN);
  }
  bool was_there(std::int64_t time_ns, ObjectId id) const {
    const std::shared_ptr<const Snapshot> state = world.memory().at(time_ns);
    return state && state->objects.find(id) != nullptr;
  }
  Answers ray_down(std::int64_t time_ns, double x) const {
    const std::vector<double> numbers{x, 0, 10, 0, 0, -1, INFINITY};
    Answers answers;
    QueryScratch scratch;
    answer(*world.memory().at(time_ns), {.kind = QuestionKind::ray, .numbers = numbers}, answers, scratch);
    return answers;
  }

  World world{WorldOptions{.memory = {.reach_ns = 30 * kMemorySecond}}};
  std::int64_t now_ns = kMemoryStart;
};

TEST_F(WorldPoseMemory, BetweenTwoPosesAnObjectGoesStraightAndBeforeItsWayItRested) {
  const ObjectId a = ball("a", 1, at(0));
  say(1, kMemoryStart, {{a, at(0)}});
  say(1, kMemoryStart + kTick, {{a, at(1)}});
  say(1, kMemoryStart + 3 * kTick, {});
  say(1, kMemoryStart + 4 * kTick, {{a, at(2)}});
  EXPECT_EQ(place(kMemoryStart, a), Vec3(0, 0, 0));
  EXPECT_EQ(place(kMemoryStart + kTick / 4, a), Vec3(0.25, 0, 0));
  EXPECT_EQ(place(kMemoryStart + kTick, a), Vec3(1, 0, 0));
  EXPECT_EQ(place(kMemoryStart + 2 * kTick, a), Vec3(1, 0, 0)) << "left out by a flush, it rested";
  EXPECT_EQ(place(kMemoryStart + 3 * kTick, a), Vec3(1, 0, 0));
  EXPECT_EQ(place(kMemoryStart + 3 * kTick + kTick / 2, a), Vec3(1.5, 0, 0));
  EXPECT_EQ(place(kMemoryStart + 4 * kTick, a), Vec3(2, 0, 0));
}

TEST_F(WorldPoseMemory, AJumpHasNoWay) {
  const ObjectId a = ball("a", 1, at(0));
  say(1, kMemoryStart, {{a, at(0)}});
  say(1, kMemoryStart + kTick, {{a, at(8)}}, true);
  EXPECT_EQ(place(kMemoryStart + kTick - 1, a), Vec3(0, 0, 0));
  EXPECT_EQ(place(kMemoryStart + kTick, a), Vec3(8, 0, 0));
}

TEST_F(WorldPoseMemory, ObjectsOfTwoPublishersStandAtOneInstant) {
  const ObjectId a = ball("a", 1, at(0));
  const ObjectId b = ball("b", 2, at(10));
  say(1, kMemoryStart, {{a, at(0)}});
  say(2, kMemoryStart + 3'000'000, {{b, at(10)}});
  for (int i = 1; i <= 5; ++i) {
    say(1, kMemoryStart + i * kTick, {{a, at(i)}});
    say(2, kMemoryStart + i * kTick + 3'000'000, {{b, at(10 - i)}});
  }
  const std::int64_t time_ns = kMemoryStart + 3 * kTick + 1'000'000;
  EXPECT_NEAR(place(time_ns, a).x(), 3.1, 1e-12);
  EXPECT_NEAR(place(time_ns, b).x(), 10 - 2.8, 1e-12);
  EXPECT_EQ(world.newest()->settled_ns, kMemoryStart + 5 * kTick) << "the first has said no more than that";
}

// The same pose lists by another way: piecewise linear in long double, over many publishers, births, ends and jumps.
TEST_F(WorldPoseMemory, IsWhatThePoseListsSayAtAnyInstant) {
  std::mt19937_64 random = oracle::seeded(30);
  std::uniform_real_distribution<double> place_of(-50, 50);
  struct Told {
    std::int64_t from_ns, to_ns;
    Vec3 pose;
  };
  struct Truth {
    std::string name;
    std::int64_t born_ns = 0, gone_ns = std::numeric_limits<std::int64_t>::max();
    Vec3 first = Vec3::Zero();
    std::vector<Told> moves;
  };
  std::map<ObjectId, Truth> truths;
  std::map<std::uint64_t, std::vector<ObjectId>> own;
  std::map<std::uint64_t, std::int64_t> last;
  int named = 0;
  for (std::uint64_t publisher = 1; publisher <= 3; ++publisher) {
    const std::string name = "ball" + std::to_string(named++);
    const ObjectId id = ball(name, publisher, at(0));
    own[publisher].push_back(id);
    last[publisher] = kMemoryStart;
    truths[id] = {.name = name, .born_ns = kMemoryStart, .moves = {}};
  }
  for (const auto& [publisher, objects] : own) world.advance(publisher, kMemoryStart);
  ASSERT_TRUE(world.step(kMemoryStart, 1, {}));
  for (int i = 0; i < 600; ++i) {
    const std::uint64_t publisher = 1 + random() % 3;
    const std::int64_t time_ns =
        std::max(last[publisher], now_ns - kTick) + 1 + static_cast<std::int64_t>(random() % kTick);
    std::vector<ObjectId>& objects = own[publisher];
    const bool teleport = random() % 9 == 0;
    std::map<ObjectId, Pose> poses;
    for (const ObjectId id : objects) {
      if (random() % 3 != 0) poses[id] = at(place_of(random), place_of(random), place_of(random));
    }
    for (const auto& [id, pose] : poses) {
      Truth& truth = truths[id];
      truth.moves.push_back({teleport ? time_ns : std::max(truth.born_ns, last[publisher]), time_ns, pose.position});
    }
    say(publisher, time_ns, poses, teleport);
    last[publisher] = time_ns;
    if (objects.size() < 5 && random() % 4 == 0) {
      const Pose pose = at(place_of(random), place_of(random), place_of(random));
      const ObjectId id = ball("ball" + std::to_string(named++), publisher, pose);
      objects.push_back(id);
      truths[id] = {
          .name = "ball" + std::to_string(named - 1), .born_ns = time_ns, .first = pose.position, .moves = {}};
      ASSERT_TRUE(world.step(now_ns, 1, {}));
    } else if (objects.size() > 2 && random() % 20 == 0) {
      ASSERT_TRUE(world.remove(objects.back(), EndReason::removed));
      ASSERT_TRUE(world.step(now_ns, 1, {}));
      truths[objects.back()].gone_ns = std::min(now_ns, last[publisher] + 1);
      objects.pop_back();
    }
  }
  const std::int64_t settled_ns = world.newest()->settled_ns;
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    const std::int64_t time_ns =
        kMemoryStart + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(settled_ns - kMemoryStart));
    const std::shared_ptr<const Snapshot> state = world.memory().at(time_ns);
    ASSERT_TRUE(state);
    EXPECT_TRUE(state->stale_objects.empty()) << "all is known of what is settled";
    std::size_t there = 0;
    for (const auto& [id, truth] : truths) {
      if (time_ns < truth.born_ns || time_ns >= truth.gone_ns) continue;
      ++there;
      Vec3 expected = truth.first;
      for (const Told& move : truth.moves) {
        if (move.to_ns <= time_ns) expected = move.pose;
        if (move.to_ns <= time_ns || move.from_ns >= time_ns) continue;
        const double part = static_cast<double>(static_cast<long double>(time_ns - move.from_ns) /
                                                static_cast<long double>(move.to_ns - move.from_ns));
        expected = expected + part * (move.pose - expected);
      }
      const auto found = std::find_if(state->objects.begin(), state->objects.end(),
                                      [&](const auto& info) { return info && info->name == truth.name; });
      ASSERT_NE(found, state->objects.end()) << truth.name;
      const auto slot = static_cast<std::size_t>(found - state->objects.begin());
      EXPECT_EQ(slot_of((*found)->id), slot);
      ASSERT_LE((state->frames[slot].position - expected).norm(), 1e-12) << i << " at " << time_ns - kMemoryStart;
      ++compared;
    }
    const auto is_object = [](const auto& info) { return info != nullptr; };
    EXPECT_EQ(static_cast<std::size_t>(std::count_if(state->objects.begin(), state->objects.end(), is_object)), there);
  }
  EXPECT_GT(compared, 1000);
}

TEST_F(WorldPoseMemory, WhatIsGoneWasThereAndWhatCameLaterWasNot) {
  const ObjectId a = ball("a", 1, at(0));
  const ObjectId other = ball("other", 1, at(50));
  say(1, kMemoryStart, {{a, at(0)}});
  say(1, kMemoryStart + kTick, {{other, at(51)}});
  ASSERT_TRUE(world.remove(a, EndReason::removed));
  now_ns = kMemoryStart + 5 * kTick;
  ASSERT_TRUE(world.step(now_ns, 1, {}));
  say(1, kMemoryStart + 3 * kTick, {{other, at(52)}});
  const ObjectId b = ball("b", 1, at(5));
  say(1, kMemoryStart + 4 * kTick, {{b, at(5)}});
  EXPECT_EQ(slot_of(a), slot_of(b)) << "in one place, one after the other";
  EXPECT_TRUE(was_there(kMemoryStart + kTick, a));
  EXPECT_FALSE(was_there(kMemoryStart + kTick + 1, a)) << "its publisher had said no more of it";
  EXPECT_FALSE(was_there(kMemoryStart + 3 * kTick - 1, b));
  EXPECT_TRUE(was_there(kMemoryStart + 3 * kTick, b));
  EXPECT_EQ(ray_down(kMemoryStart + kTick / 2, 0).answers.at(0), Verdict::hit);
  EXPECT_EQ(ray_down(kMemoryStart + 2 * kTick, 0).answers.at(0), Verdict::miss);
  EXPECT_EQ(ray_down(kMemoryStart + 3 * kTick, 5).answers.at(0), Verdict::hit);
}

// Two maps would take the room of two.
TEST_F(WorldPoseMemory, ItBeginsAnewWhereStaticGeometryChanges) {
  const ObjectId a = ball("a", 1, at(0));
  say(1, kMemoryStart, {{a, at(0)}});
  say(1, kMemoryStart + kTick, {{a, at(1)}});
  Scene scene;
  scene.name = "scene";
  scene.mesh = {{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {{0, 1, 2}}};
  scene.parts = {{.name = "scene/part", .first_triangle = 0, .triangle_count = 1}};
  auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
  const std::weak_ptr<const StaticScene> seen = indexed.geometry;
  ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(indexed)));
  indexed = {};
  say(1, kMemoryStart + 2 * kTick, {{a, at(2)}});
  EXPECT_EQ(world.memory().at(kMemoryStart + kTick), nullptr);
  EXPECT_EQ(ray_down(kMemoryStart + 2 * kTick, -3).answers.at(0), Verdict::hit) << "the scene";
  world.remove_scene("scene");
  say(1, kMemoryStart + 3 * kTick, {{a, at(3)}});
  EXPECT_EQ(world.memory().at(kMemoryStart + 2 * kTick), nullptr);
  EXPECT_EQ(ray_down(kMemoryStart + 3 * kTick, -3).answers.at(0), Verdict::miss);
  for (int i = 4; i < 40; ++i) say(1, kMemoryStart + i * kTick, {{a, at(i)}});
  EXPECT_TRUE(seen.expired()) << "nothing of it is kept";
}

// Another publisher goes on; where the silent one's object may have come to, nothing is called free.
TEST_F(WorldPoseMemory, BeyondWhatIsKnownNothingWithinReachIsDecided) {
  const ObjectId a = ball("a", 1, at(0));
  const ObjectId b = ball("b", 2, at(100));
  say(1, kMemoryStart, {{a, at(0)}});
  say(1, kMemoryStart + kTick, {{a, at(0.1)}});  // 10 m/s
  say(2, kMemoryStart + 2 * kMemorySecond, {{b, at(100)}});
  const std::int64_t time_ns = kMemoryStart + kMemorySecond;
  EXPECT_EQ(world.newest()->settled_ns, kMemoryStart + kTick);
  EXPECT_EQ(ray_down(kMemoryStart + kTick, 5).answers.at(0), Verdict::miss) << "known: it was at 0.1 then";
  EXPECT_EQ(ray_down(time_ns, 5).answers.at(0), Verdict::undecided);
  EXPECT_EQ(ray_down(time_ns, 5).reasons.at(0), UndecidedReason::stale_object);
  EXPECT_EQ(ray_down(time_ns, 60).answers.at(0), Verdict::miss) << "it cannot have come so far";
  EXPECT_EQ(ray_down(time_ns, 100).answers.at(0), Verdict::hit) << "the other one stands in no doubt";
}

TEST_F(WorldPoseMemory, ReachesAsFarBackAsItWasAskedTo) {
  const ObjectId a = ball("a", 1, at(0));
  for (int i = 0; i <= 400; ++i) say(1, kMemoryStart + i * kMemorySecond / 10, {{a, at(i)}});
  const PoseMemory::Reach reach = world.memory().reach();
  EXPECT_EQ(reach.to_ns - reach.from_ns, 30 * kMemorySecond);
  EXPECT_EQ(world.memory().at(reach.from_ns - 1), nullptr);
  EXPECT_EQ(world.memory().at(reach.to_ns + 1), nullptr) << "nobody knows what will be";
  EXPECT_EQ(place(reach.from_ns, a), Vec3(100, 0, 0));
  EXPECT_LE(world.memory().bytes(), 2 * 301 * 80u) << "what lies behind is forgotten";
}

TEST(WorldPoseMemoryBounds, WithMorePosesThanThereIsRoomForItReachesLessFar) {
  World world{WorldOptions{.memory = {.reach_ns = 3'600 * kMemorySecond, .max_bytes = 100'000}}};
  ObjectDefinition definition;
  definition.publisher = 1;
  definition.shape.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = 1}};
  std::vector<ObjectId> ids;
  for (int i = 0; i < 10; ++i) {
    definition.name = "ball" + std::to_string(i);
    ids.push_back(std::get<ObjectId>(world.define(definition)));
  }
  for (int i = 1; i <= 3'000; ++i) {
    for (const ObjectId id : ids) world.move(id, at(i), kMemoryStart + i * kTick, false);
    world.advance(1, kMemoryStart + i * kTick);
    ASSERT_TRUE(world.step(kMemoryStart + i * kTick, 1, {}));
  }
  EXPECT_LE(world.memory().bytes(), 250'000u);
  const PoseMemory::Reach reach = world.memory().reach();
  EXPECT_GT(reach.to_ns - reach.from_ns, kMemorySecond / 2);
  EXPECT_LT(reach.to_ns - reach.from_ns, 4 * kMemorySecond);
  EXPECT_EQ(world.memory().at(reach.to_ns)->frames[slot_of(ids[0])].position.x(), 3'000);
}

TEST(WorldPoseMemoryBounds, WithoutReachNothingIsKept) {
  World world{WorldOptions{}};
  ASSERT_TRUE(world.step(kMemoryStart, 1, {}));
  EXPECT_FALSE(world.memory().is_on());
  EXPECT_EQ(world.memory().bytes(), 0u);
  EXPECT_EQ(world.memory().at(kMemoryStart), nullptr);
}

}  // namespace
}  // namespace collided::engine
