#include "server/service/ingest/publishers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace collided::engine::service {
namespace {

using wire_contract::PublisherState;

constexpr std::uint64_t kPublisher = 7;

/// A world with a floor at z = 0 and publishers around it, without DDS.
class PublishersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Scene scene{.name = "room"};
    scene.mesh.vertices = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    scene.mesh.triangles = {{0, 1, 2}};
    scene.parts = {{.name = "room/floor", .first_triangle = 0, .triangle_count = 1, .filter = {}}};
    const auto indexed = World::index_scene(scene, {});
    ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(scene, indexed)));
    step();
  }
  static DefinitionSample definition(std::uint32_t number, std::uint64_t sequence, const std::string& name,
                                     double z = 3) {
    DefinitionSample sample;
    sample.publisher = kPublisher;
    sample.object_number = number;
    sample.incarnation = 1;
    sample.sequence = sequence;
    sample.name = name;
    sample.publisher_name = "test";
    sample.pose = {0, 0, z, 1, 0, 0, 0};
    Shape ball;
    ball.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.5});
    sample.shape = ball;
    return sample;
  }
  static DefinitionSample removal(std::uint32_t number, std::uint64_t sequence) {
    DefinitionSample sample = definition(number, sequence, "");
    sample.removed = true;
    return sample;
  }
  static PoseSample pose(std::uint64_t sequence, const std::vector<std::pair<std::uint32_t, double>>& heights,
                         std::uint64_t through = 0) {
    PoseSample sample;
    sample.publisher = kPublisher;
    sample.incarnation = 1;
    sample.sequence = sequence;
    sample.definitions_through = through;
    for (const auto& [number, z] : heights) {
      sample.object_numbers.push_back(number);
      sample.poses.insert(sample.poses.end(), {0, 0, z, 1, 0, 0, 0});
    }
    return sample;
  }
  void step() {
    ASSERT_TRUE(world.step(++now_ns, 1, {}));
    publishers.stepped();
    for (const Event& event : world.events()) events.push_back(event);
  }
  void define(DefinitionSample sample) {
    while (publishers.define(sample, now_ns) == Applied::step_first) step();
    while (publishers.release_parked(now_ns) == Applied::step_first) step();
  }
  void move(PoseSample sample) {
    sample.received_ns = ++now_ns;
    while (publishers.move(sample, now_ns) == Applied::step_first) step();
  }
  void lose() {
    for (const WriterKind kind : {WriterKind::object, WriterKind::pose}) {
      while (publishers.writer_lost(kPublisher, kind, now_ns) == Applied::step_first) step();
    }
  }
  double height(const std::string& name) {
    const std::optional<ObjectId> id = world.find(name);
    return id ? world.newest()->poses[slot_of(*id)].position.z() : std::numeric_limits<double>::quiet_NaN();
  }

  World world{WorldOptions{}};
  Publishers publishers{world, PublisherLimits{.publishers = 3, .object_numbers = 20, .parked_batches = 2}};
  std::int64_t now_ns = 1'000;
  std::vector<Event> events;
};

TEST_F(PublishersTest, LateAndRepeatedSamplesChangeNothing) {
  define(definition(1, 1, "ball"));
  move(pose(3, {{1, 2}}));
  move(pose(2, {{1, 9}}));  // overtaken
  move(pose(3, {{1, 8}}));  // again
  define(definition(1, 1, "other"));
  step();
  EXPECT_EQ(height("ball"), 2);
  EXPECT_FALSE(world.find("other"));
  EXPECT_EQ(publishers.counts().poses_late, 2U);
  EXPECT_EQ(publishers.counts().definitions_late, 1U);
  EXPECT_EQ(publishers.counts().poses_applied, 1U);
}

// A robot of more links than a batch holds is not seen half-moved.
TEST_F(PublishersTest, BatchesOfOneInstantLandTogether) {
  define(definition(1, 1, "first"));
  define(definition(2, 2, "second"));
  step();
  PoseSample part = pose(3, {{1, 5}});
  part.flags = wire_contract::kMoreFollows;
  move(part);
  step();
  EXPECT_EQ(height("first"), 3) << "more of its instant is to come";
  EXPECT_EQ(publishers.applied_through(kPublisher), 2U);
  move(pose(4, {{2, 6}}));
  step();
  EXPECT_EQ(height("first"), 5);
  EXPECT_EQ(height("second"), 6);
  EXPECT_EQ(publishers.applied_through(kPublisher), 4U);
}

// Two publishers' balls meet at 1.05 s between their poses; the one's stamps come 20 ms late.
TEST_F(PublishersTest, WhatTwoPublishersSayOfOneInstantMeets) {
  constexpr std::int64_t kMs = 1'000'000;
  now_ns = 1'000 * kMs;
  DefinitionSample other = definition(1, 1, "other", 9);
  other.publisher = kPublisher + 1;
  define(definition(1, 1, "ball", 5));
  define(other);
  step();
  const auto say = [&](std::uint64_t publisher, std::uint64_t sequence, std::int64_t time_ns, const Vec3& at) {
    PoseSample sample = pose(sequence, {{1, at.z()}});
    sample.publisher = publisher;
    sample.source_time_ns = time_ns;
    sample.poses[0] = at.x();
    now_ns = std::max(now_ns, time_ns + (publisher == kPublisher ? 0 : 20 * kMs));
    move(sample);
    step();
  };
  // Along x and along z, through (0, 20) at 1.05 s with 100 m/s.
  for (std::uint64_t i = 0; i < 10; ++i) {
    const std::int64_t time_ns = (1'005 + 10 * static_cast<std::int64_t>(i)) * kMs;
    const double along_m = 100 * (1e-9 * static_cast<double>(time_ns) - 1.05);
    say(kPublisher, 2 + i, time_ns, {along_m, 0, 20});
    say(kPublisher + 1, 2 + i, time_ns + 3 * kMs, {0, 0, 20 + along_m + 0.3});
  }
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].kind, EventKind::began);
  EXPECT_EQ(events[1].kind, EventKind::ended);
  EXPECT_EQ(events[1].reason, EndReason::separated);
}

// Nothing is lost of a clock that is set back a little: where things are is news.
TEST_F(PublishersTest, AStampThatGoesBackIsTakenAndCounted) {
  define(definition(1, 1, "ball"));
  PoseSample first = pose(2, {{1, 2}});
  first.source_time_ns = 900;
  PoseSample late = pose(3, {{1, 4}});
  late.source_time_ns = 800;
  move(first);
  move(late);
  step();
  EXPECT_EQ(height("ball"), 4);
  EXPECT_EQ(publishers.counts().stamps_late, 1U);
}

// One that jumps, an hour ahead here, tells nothing of the way; one that says no time is known by when its batches came.
TEST_F(PublishersTest, StampsThatJumpOrAreMissingAreCounted) {
  define(definition(1, 1, "ball"));
  const auto say = [&](std::uint64_t sequence, std::int64_t time_ns, double height) {
    PoseSample sample = pose(sequence, {{1, height}});
    sample.source_time_ns = time_ns;
    sample.received_ns = now_ns;
    move(sample);
    step();
  };
  constexpr std::int64_t kHourNs = 3'600'000'000'000;
  say(2, now_ns, 1);
  EXPECT_EQ(publishers.counts().stamps_jumped + publishers.counts().stamps_missing + publishers.counts().stamps_late,
            0U);
  say(3, now_ns + kHourNs, 2);
  EXPECT_EQ(publishers.counts().stamps_jumped, 1U);
  say(4, now_ns + kHourNs, 3);
  EXPECT_EQ(publishers.counts().stamps_jumped, 1U) << "it goes on from there";
  say(5, 0, 4);
  say(6, 0, 5);
  EXPECT_EQ(publishers.counts().stamps_missing, 2U);
  EXPECT_EQ(publishers.counts().stamps_late, 0U);
  EXPECT_EQ(height("ball"), 5);
}

// A slot is used again: a pose that was sent for the earlier object must not move the later one.
TEST_F(PublishersTest, APoseOlderThanItsDefinitionIsForAnEarlierObject) {
  define(definition(1, 1, "first"));
  define(removal(1, 3));
  define(definition(1, 4, "second"));
  move(pose(2, {{1, 9}}));
  step();
  EXPECT_FALSE(world.find("first"));
  EXPECT_EQ(height("second"), 3);
  EXPECT_EQ(publishers.counts().poses_late, 1U);
}

TEST_F(PublishersTest, BatchesWaitForTheirDefinitions) {
  move(pose(5, {{1, 2}}, 4));
  EXPECT_EQ(publishers.counts().batches_parked, 1U);
  EXPECT_EQ(publishers.applied_through(kPublisher), 0U);
  define(definition(1, 4, "ball"));
  step();
  EXPECT_EQ(height("ball"), 2);
  EXPECT_EQ(publishers.applied_through(kPublisher), 5U);
}

// Every pose that a publisher may have under way is looked at, also where its definition comes last of all.
TEST_F(PublishersTest, AllBatchesUnderWayWaitForALateDefinition) {
  constexpr std::uint64_t kUnderWay = wire_contract::kPoseTopic.keep_last;
  Publishers patient{world, {}};
  const auto finish = [&](const auto& apply) {
    while (apply() == Applied::step_first) {
      ASSERT_TRUE(world.step(++now_ns, 1, {}));
      patient.stepped();
    }
  };
  for (std::uint64_t i = 0; i < kUnderWay; ++i) {
    PoseSample sample = pose(5 + i, {{1, static_cast<double>(i)}}, 4);
    finish([&] { return patient.move(sample, now_ns); });
  }
  DefinitionSample late = definition(1, 4, "ball");
  finish([&] { return patient.define(late, now_ns); });
  finish([&] { return patient.release_parked(now_ns); });
  EXPECT_EQ(patient.counts().batches_dropped, 0U);
  EXPECT_EQ(patient.counts().poses_applied, kUnderWay);
}

TEST_F(PublishersTest, ParkedBatchesAreBounded) {
  for (std::uint64_t sequence = 5; sequence < 10; ++sequence)
    move(pose(sequence, {{1, static_cast<double>(sequence)}}, 4));
  EXPECT_EQ(publishers.counts().batches_dropped, 3U);
  define(definition(1, 4, "ball"));
  step();
  EXPECT_EQ(height("ball"), 9);
}

// Every accepted pose is examined: through the floor and back within one step would be missed.
TEST_F(PublishersTest, AnObjectThatMovedWaitsForAStep) {
  define(definition(1, 1, "ball"));
  step();
  move(pose(2, {{1, 0.1}}));
  PoseSample next = pose(3, {{1, 3}});
  EXPECT_EQ(publishers.move(next, now_ns), Applied::step_first);
  move(next);
  step();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].kind, EventKind::began);
  EXPECT_EQ(events[1].kind, EventKind::ended);
}

TEST_F(PublishersTest, AnObjectThatIsRemovedAtOnceHasBeenThere) {
  define(definition(1, 1, "ball", 0.1));
  define(removal(1, 2));
  step();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[1].reason, EndReason::removed);
}

TEST_F(PublishersTest, ABadPoseIsRefusedAndItsNeighboursAreApplied) {
  define(definition(1, 1, "good"));
  define(definition(2, 2, "bad"));
  PoseSample sample = pose(3, {{1, 2}, {2, 2}, {9, 2}});
  sample.poses[7 + 3] = 0.99;  // |q|
  move(sample);
  step();
  EXPECT_EQ(height("good"), 2);
  EXPECT_EQ(height("bad"), 3);
  EXPECT_EQ(publishers.counts().poses_refused, 1U);
  EXPECT_EQ(publishers.counts().poses_unknown, 1U);
  const std::vector<std::string> notices = publishers.take_notices();
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(
      notices[0],
      "pose of object 'bad' of publisher 'test' refused: quaternion norm 0.99, allowed 1 +- 1e-06. Refused so far: 1.");
}

TEST_F(PublishersTest, QuaternionsAreDividedByTheirNormOnce) {
  define(definition(1, 1, "ball"));
  PoseSample sample = pose(2, {{1, 2}});
  const double scale = 1 + 0.9e-6;
  const double q[] = {0.6 * scale, 0.8 * scale, 0, 0};
  std::copy_n(q, 4, &sample.poses[3]);
  move(sample);
  step();
  const Quat rotation = world.newest()->poses[slot_of(*world.find("ball"))].rotation;
  EXPECT_NEAR(rotation.norm(), 1, 1e-15);
}

TEST_F(PublishersTest, MalformedBatchesAreCountedWhole) {
  define(definition(1, 1, "ball"));
  PoseSample sample = pose(2, {{1, 2}});
  sample.poses.pop_back();
  move(sample);
  sample = pose(3, {{1, 2}});
  sample.velocities = {1, 2, 3};
  move(sample);
  EXPECT_EQ(publishers.counts().batches_malformed, 2U);
  EXPECT_EQ(publishers.counts().poses_applied, 0U);
  EXPECT_EQ(publishers.applied_through(kPublisher), 3U) << "who waits for a malformed sample must not wait for ever";
}

TEST_F(PublishersTest, TheFirstKeepsItsNameAndTheSecondWaits) {
  define(definition(1, 1, "ball"));
  DefinitionSample second = definition(1, 1, "ball", 5);
  second.publisher = 8;
  define(second);
  step();
  EXPECT_EQ(height("ball"), 3);
  EXPECT_EQ(publishers.counts().name_conflicts, 1U);
  EXPECT_EQ(publishers.waiting_for("ball"), std::vector<std::uint64_t>{8});
  define(removal(1, 2));
  publishers.settle(now_ns);
  step();
  EXPECT_EQ(height("ball"), 5);
  EXPECT_TRUE(publishers.waiting_for("ball").empty());
}

// A program that restarts is another publisher; what the dead one has frozen makes room at once.
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

TEST_F(PublishersTest, ANewIncarnationStartsEmpty) {
  define(definition(1, 10, "old"));
  step();
  DefinitionSample fresh = definition(2, 1, "new");
  fresh.incarnation = 2;
  define(fresh);
  move(pose(11, {{1, 9}}));  // of the earlier incarnation
  step();
  EXPECT_FALSE(world.find("old"));
  EXPECT_EQ(height("new"), 3);
  EXPECT_EQ(publishers.counts().poses_late, 1U);
}

TEST_F(PublishersTest, PublishersAndNumbersAreBounded) {
  for (std::uint64_t publisher = 1; publisher <= 5; ++publisher) {
    DefinitionSample sample =
        definition(1, 1, "ball" + std::to_string(publisher), 2.0 * static_cast<double>(publisher));
    sample.publisher = publisher;
    define(sample);
  }
  EXPECT_EQ(publishers.size(), 3U);
  EXPECT_EQ(publishers.counts().publishers_refused, 2U);
  for (std::uint32_t number = 2; number < 40; ++number) {
    DefinitionSample sample = definition(number << 20, number, "n" + std::to_string(number), 2.0 * number);
    sample.publisher = 1;
    define(sample);
  }
  EXPECT_EQ(publishers.counts().definitions_refused, 21U);  // 38 offered, 17 of 20 numbers were free
}

TEST_F(PublishersTest, BadDefinitionsLeaveWhatIsThere) {
  define(definition(1, 1, "ball"));
  DefinitionSample bad = definition(1, 2, std::string("ba\xffll"));
  define(bad);
  bad = definition(1, 3, "ball");
  bad.lost_policy = 3;
  define(bad);
  bad = definition(1, 4, "ball");
  bad.shape = Refusal{"sphere 0: radius -1"};
  define(bad);
  bad = definition(1, 5, "ball");
  bad.pose[0] = std::numeric_limits<double>::infinity();
  define(bad);
  step();
  EXPECT_EQ(publishers.counts().definitions_refused, 4U);
  EXPECT_EQ(height("ball"), 3);
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
TEST_F(PublishersTest, AVelocityIsThatOfTheNewestPose) {
  define(definition(1, 1, "ball"));
  define(definition(2, 2, "other", 5));
  const auto with_velocity = [&](std::uint64_t sequence, double start) {
    PoseSample sample = pose(sequence, {{1, 2}, {2, 5}});
    for (int i = 0; i < 12; ++i) sample.velocities.push_back(start + i);
    move(sample);
    step();
  };
  const auto velocity_of = [&](const std::string& name) { return publishers.velocity(*world.find(name)); };
  EXPECT_FALSE(velocity_of("ball"));
  with_velocity(3, 10);
  EXPECT_EQ(velocity_of("ball"), (std::array<double, 6>{10, 11, 12, 13, 14, 15}));
  EXPECT_EQ(velocity_of("other"), (std::array<double, 6>{16, 17, 18, 19, 20, 21}));
  with_velocity(4, 30);
  EXPECT_EQ(velocity_of("ball"), (std::array<double, 6>{30, 31, 32, 33, 34, 35}));
  move(pose(5, {{1, 2}}));
  step();
  EXPECT_FALSE(velocity_of("ball")) << "an old velocity is none";
  EXPECT_EQ(velocity_of("other"), (std::array<double, 6>{36, 37, 38, 39, 40, 41})) << "the pose was not its";
  define(definition(2, 6, "other", 5));
  step();
  EXPECT_FALSE(velocity_of("other")) << "it is another object now";
}

// DDS says that the writer is heard again before any sample of it comes.
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
TEST_F(PublishersTest, AFullWaitingRoomKeepsTheNewestPoses) {
  for (std::uint64_t i = 0; i < 4; ++i)
    move(pose(5 + i, {{1, static_cast<double>(2 + i)}, {static_cast<std::uint32_t>(2 + i), 9}}, 4));
  EXPECT_EQ(publishers.counts().batches_dropped, 2U);
  define(definition(1, 4, "ball"));
  step();
  EXPECT_EQ(height("ball"), 5);
  EXPECT_EQ(publishers.counts().batches_applied, 2U);
}

// A restart empties the waiting room: nothing of the earlier life is applied in the later one.
TEST_F(PublishersTest, BatchesThatWaitedForAnEarlierLifeAreNotApplied) {
  move(pose(5, {{1, 2}}, 4));
  DefinitionSample fresh = definition(1, 4, "ball");
  fresh.incarnation = 2;
  define(fresh);
  step();
  EXPECT_EQ(height("ball"), 3);
  EXPECT_EQ(publishers.counts().batches_applied, 0U);
  EXPECT_EQ(publishers.applied_through(kPublisher), 4U) << "5 was of the earlier life";
}

// The room of what a restarted program had is free again.
TEST_F(PublishersTest, ARestartGivesItsObjectNumbersBack) {
  for (std::uint64_t life = 1; life <= 5; ++life) {
    for (std::uint32_t number = 1; number <= 10; ++number) {
      DefinitionSample sample = definition(number, number, "n" + std::to_string(number), 2.0 * number);
      sample.incarnation = life;
      define(sample);
    }
    step();
  }
  EXPECT_EQ(publishers.counts().definitions_refused, 0U);
}

TEST_F(PublishersTest, AnObjectThatWasRemovedLeavesItsNameAndNumberToTheNext) {
  define(definition(1, 1, "ball"));
  step();
  define(removal(1, 2));
  define(definition(1, 3, "box", 4));
  define(definition(2, 4, "ball", 6));
  step();
  EXPECT_EQ(height("box"), 4);
  EXPECT_EQ(height("ball"), 6);
  EXPECT_EQ(publishers.counts().name_conflicts, 0U);
}

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

TEST_F(PublishersTest, ATeleportIsNoWayAndAMoveIs) {
  define(definition(1, 1, "ball"));
  step();
  events.clear();
  PoseSample jump = pose(2, {{1, -3}});
  jump.flags = wire_contract::kTeleported;
  move(jump);
  step();
  EXPECT_TRUE(events.empty()) << "through the floor, but not past it";
  move(pose(3, {{1, 3}}));
  step();
  EXPECT_EQ(events.size(), 2U);
}

TEST_F(PublishersTest, EveryPublisherIsShownWithItsNameAndSilence) {
  define(definition(1, 1, "ball"));
  DefinitionSample other = definition(1, 1, "box", 5);
  other.publisher = 8;
  other.publisher_name = "arm";
  now_ns += 500;
  define(other);
  step();
  std::vector<std::pair<std::string, std::int64_t>> shown;
  const std::int64_t reported_ns = now_ns - 1;
  publishers.for_each(reported_ns + 100, [&](const PublisherView& view) {
    EXPECT_EQ(view.publisher, shown.empty() ? kPublisher : 8U);
    shown.emplace_back(view.name, view.silent_ns);
  });
  EXPECT_EQ(shown, (std::vector<std::pair<std::string, std::int64_t>>{{"test", 600}, {"arm", 100}}));
}

// Definitions of two objects may come in either order: what has been seen is the newest of them.
TEST_F(PublishersTest, AnOlderDefinitionThatComesLateUnsaysNoneOfTheNewer) {
  define(definition(2, 4, "newer", 6));
  define(definition(1, 3, "older"));
  move(pose(5, {{1, 2}}, 4));
  step();
  EXPECT_EQ(publishers.counts().batches_parked, 0U);
  EXPECT_EQ(height("older"), 2);
  EXPECT_EQ(publishers.applied_through(kPublisher), 5U);
}

// Somebody else has taken the object out of the world: its number says nothing of what has its slot now.
TEST_F(PublishersTest, APoseOfAnObjectThatIsGoneMovesNobody) {
  define(definition(1, 1, "ball"));
  step();
  const ObjectId gone = *world.find("ball");
  world.remove(gone, EndReason::removed);
  step();
  ObjectDefinition other;
  other.name = "other";
  other.shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.5});
  other.pose.position = {0, 0, 7};
  const auto defined = world.define(other);
  ASSERT_EQ(slot_of(std::get<ObjectId>(defined)), slot_of(gone));
  move(pose(2, {{1, 2}}));
  step();
  EXPECT_EQ(height("other"), 7);
  EXPECT_EQ(publishers.counts().poses_unknown, 1U);
}

// A publisher without stamps that rests says so by empty batches: whoever comes to what it has is told, and does not wait for it
// to move again.
TEST_F(PublishersTest, EmptyBatchesOfAPublisherWithoutStampsSayThatItRests) {
  constexpr std::int64_t kMs = 1'000'000;
  const auto of = [](auto sample, std::uint64_t publisher) {
    sample.publisher = publisher;
    return sample;
  };
  const auto at = [](PoseSample sample, std::int64_t time_ns) {
    sample.source_time_ns = time_ns;
    return sample;
  };
  now_ns = 1'000 * kMs;
  define(definition(0, 1, "resting", 3));
  define(of(definition(0, 1, "comer", 6), 8));
  move(pose(2, {{0, 3.1}}));
  move(of(at(pose(2, {{0, 6}}), now_ns), 8));
  step();
  now_ns += 10 * kMs;
  move(of(at(pose(3, {{0, 4}}), now_ns), 8));
  step();
  EXPECT_TRUE(world.contacts().empty()) << "where the other is by now is not known";
  now_ns += 10 * kMs;
  move(pose(3, {}));
  step();
  EXPECT_EQ(world.contacts().size(), 1u);
}

}  // namespace
}  // namespace collided::engine::service
