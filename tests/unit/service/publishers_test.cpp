// Definitions and poses of a publisher, in whatever order they come.
#include "server/service/ingest/publishers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include "tests/unit/service/publishers_fixture.hpp"

namespace collided::engine::service {
namespace {

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
  part.flags = wire_contract::kPosesMoreFollows;
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

/// What is said again comes on another topic than poses, and may be faster.
TEST_F(PublishersTest, ADefinitionSaidAgainTakesItsPlaceAmongTheBatchesThatItOvertook) {
  define(definition(0, 1, "ball"));
  step();
  move(pose(2, {{0, 4}}));
  step();
  define(definition(0, 5, "ball", 6));
  step();
  EXPECT_EQ(height("ball"), 4) << "batches 3 and 4 are still under way";
  move(pose(3, {{0, -1}}));  // through the floor
  step();
  move(pose(4, {{0, 6}}));
  step();
  move(pose(6, {{0, 7}}, 5));
  step();
  EXPECT_EQ(height("ball"), 7);
  std::vector<EventKind> kinds;
  for (const Event& event : events) {
    kinds.push_back(event.kind);
    EXPECT_NE(event.reason, EndReason::geometry_changed) << "it was not placed";
  }
  EXPECT_EQ(kinds, (std::vector{EventKind::began, EventKind::ended, EventKind::began, EventKind::ended}));
  EXPECT_EQ(publishers.counts().poses_late, 0U);
}

TEST_F(PublishersTest, WhatWasSaidAgainPlacesAnObjectWhoseBatchesWereLost) {
  define(definition(0, 1, "ball"));
  step();
  move(pose(2, {{0, 4}}));
  step();
  define(definition(0, 5, "ball", 6));
  move(pose(6, {}, 5));  // 3 and 4 never come
  step();
  EXPECT_EQ(height("ball"), 6);
  // And where no batch follows, once nobody waits for them any more.
  define(definition(0, 9, "ball", 8));
  step();
  EXPECT_EQ(height("ball"), 6);
  now_ns += 2 * SequenceWatermark::kGapPatienceNs;
  publishers.settle(now_ns);
  step();
  EXPECT_EQ(height("ball"), 8);
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

// Two hundred publishers that never define what they move took a gigabyte.
TEST_F(PublishersTest, ParkedBatchesOfAllPublishersAreBoundedAndTheGreediestLosesItsOldest) {
  constexpr std::size_t kRoom = 10, kOfOne = sizeof(PoseSample) + 4 + 7 * sizeof(double);
  Publishers crowded{world, {.parked_bytes = kRoom * kOfOne}};
  const auto park = [&](std::uint64_t publisher, std::uint64_t sequence) {
    PoseSample sample = pose(sequence, {{1, 2}}, 4);
    sample.publisher = publisher;
    while (crowded.move(sample, now_ns) == Applied::step_first) {
      ASSERT_TRUE(world.step(++now_ns, 1, {}));
      crowded.stepped();
    }
  };
  constexpr std::uint64_t kModest = kPublisher, kGreedy = kPublisher + 1;
  for (std::uint64_t i = 0; i < 20; ++i) park(kGreedy, 5 + i);
  for (std::uint64_t i = 0; i < 3; ++i) park(kModest, 5 + i);
  for (std::uint64_t i = 20; i < 40; ++i) park(kGreedy, 5 + i);
  EXPECT_EQ(crowded.counts().batches_dropped, 43U - kRoom);
  const auto finish = [&](const auto& apply) {
    while (apply() == Applied::step_first) {
      ASSERT_TRUE(world.step(++now_ns, 1, {}));
      crowded.stepped();
    }
  };
  DefinitionSample late = definition(1, 4, "ball");
  finish([&] { return crowded.define(late, now_ns); });
  finish([&] { return crowded.release_parked(now_ns); });
  EXPECT_EQ(crowded.counts().poses_applied, 3U) << "all of the modest one's";
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

TEST_F(PublishersTest, QuaternionsStayAsTheyWereGivenAndTurnByTheirDirection) {
  define(definition(1, 1, "ball"));
  PoseSample sample = pose(2, {{1, 2}});
  const double scale = 1 + 0.9e-6;
  const double q[] = {0.6 * scale, 0.8 * scale, 0, 0};
  std::copy_n(q, 4, &sample.poses[3]);
  move(sample);
  step();
  const auto state = world.newest();
  const std::uint32_t slot = slot_of(*world.find("ball"));
  EXPECT_EQ(state->poses[slot].rotation.coeffs(), Quat(q[0], q[1], q[2], q[3]).coeffs());
  EXPECT_TRUE(state->frame(slot).rotation.isApprox(Quat(0.6, 0.8, 0, 0).toRotationMatrix(), 1e-15));
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
  EXPECT_TRUE(velocity_of("other")) << "it is what it was";
  define(definition(2, 7, "other", 6));
  step();
  EXPECT_FALSE(velocity_of("other")) << "it is another object now";
}

// DDS says that the writer is heard again before any sample of it comes.

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

TEST_F(PublishersTest, ATeleportIsNoWayAndAMoveIs) {
  define(definition(1, 1, "ball"));
  step();
  events.clear();
  PoseSample jump = pose(2, {{1, -3}});
  jump.flags = wire_contract::kPosesTeleported;
  move(jump);
  step();
  EXPECT_TRUE(events.empty()) << "through the floor, but not past it";
  move(pose(3, {{1, 3}}));
  step();
  EXPECT_EQ(events.size(), 2U);
}

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

// Its own gap comes before all else that a publisher says, under an object number of its own.
TEST_F(PublishersTest, APublishersGapSaysUpToWhenItsPosesConnect) {
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  const auto place_at = [&](double gap_s, std::int64_t ago_ns) {
    World own{WorldOptions{.memory = {.reach_ns = 60 * kSecondNs}}};
    Publishers own_publishers{own, PublisherLimits{}};
    DefinitionSample itself = removal(wire_contract::kObjectPublisherItself, 1);
    itself.pose[0] = gap_s;
    std::int64_t time_ns = 1'000 * kSecondNs;
    const auto next = [&] {
      EXPECT_TRUE(own.step(time_ns, 1, {}));
      own_publishers.stepped();
    };
    next();
    own_publishers.define(itself, time_ns);
    DefinitionSample ball = definition(1, 2, "ball", 0);
    own_publishers.define(ball, time_ns);
    next();
    for (const double height : {0.0, 10.0}) {
      PoseSample sample = pose(3 + static_cast<std::uint64_t>(height), {{1, height}});
      sample.source_time_ns = sample.received_ns = time_ns += 4 * kSecondNs;
      own_publishers.move(sample, time_ns);
      next();
    }
    const auto state = own.memory().at(time_ns - ago_ns);
    return state->poses[slot_of(*own.find("ball"))].position.z();
  };
  EXPECT_NEAR(place_at(5, 2 * kSecondNs), 5, 1e-9) << "the poses are 4 s apart";
  EXPECT_NEAR(place_at(2, kSecondNs), 5, 1e-9);
  EXPECT_EQ(place_at(2, 2 * kSecondNs), 0);
  EXPECT_EQ(place_at(1.5, 1'500'000'000), 0);
}

TEST_F(PublishersTest, AGapOutOfBoundsIsRefused) {
  std::uint64_t sequence = 0;
  for (const double gap_s : {0.0, -1.0, 1e-9, 8.001, std::numeric_limits<double>::quiet_NaN()}) {
    DefinitionSample itself = removal(wire_contract::kObjectPublisherItself, ++sequence);
    itself.pose[0] = gap_s;
    define(itself);
    EXPECT_EQ(publishers.counts().definitions_refused, sequence);
    EXPECT_NE(publishers.take_notices().at(0).find("; allowed 0.001 to 8. It stays 1.5 s."), std::string::npos);
  }
  EXPECT_EQ(publishers.applied_through(kPublisher), sequence);
}

TEST_F(PublishersTest, AnObjectsRestIsNoSlowPublisher) {
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  define(definition(1, 1, "ball"));
  std::uint64_t sequence = 1;
  const auto after = [&](std::int64_t pause_ns) {
    PoseSample sample = pose(++sequence, {{1, 4 + 1e-3 * static_cast<double>(sequence)}});
    sample.source_time_ns = now_ns += pause_ns;
    move(sample);
    step();
    return publishers.take_notices();
  };
  now_ns += kSecondNs;
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(after(3 * kSecondNs).empty());
    EXPECT_TRUE(after(kSecondNs).empty());
  }
  after(2 * kSecondNs), after(2 * kSecondNs);
  const std::vector<std::string> said = after(2 * kSecondNs);
  ASSERT_EQ(said.size(), 1U) << "three in a row";
  EXPECT_NE(said[0].find("publisher 'test' sends poses 2 s apart, and its gap is 1.5 s"), std::string::npos) << said[0];
  EXPECT_TRUE(after(2 * kSecondNs).empty()) << "once";
}

// A pipe that pauses: the row of 2 s comes late, when signs of life have named 2.3 s already.
TEST_F(PublishersTest, APoseStampedBeforeASignOfLifeIsNotLate) {
  constexpr std::int64_t kMs = 1'000'000;
  now_ns = 8'000 * kMs;
  define(definition(1, 1, "ball"));
  step();
  now_ns = 9'000 * kMs;
  const auto say = [&](PoseSample sample, std::int64_t time_ns, std::uint8_t flags) {
    now_ns = std::max(now_ns, time_ns);
    sample.source_time_ns = time_ns;
    sample.flags = flags;
    move(sample);
    step();
  };
  say(pose(2, {{1, 4}}), 9'000 * kMs, 0);
  for (int ms = 9'250; ms <= 10'300; ms += 250) say(pose(0, {}), ms * kMs, wire_contract::kPosesStreamed);
  say(pose(3, {{1, 6}}), 10'000 * kMs, 0);
  EXPECT_EQ(publishers.counts().stamps_late, 0U);
  EXPECT_EQ(world.newest()->posed_ns[slot_of(*world.find("ball"))], 10'000 * kMs);
}

// Else its objects would be known up to the server's own time, and its first poses be late.
TEST_F(PublishersTest, AStreamedPublishersTimeBeginsWithItsFirstWord) {
  constexpr std::int64_t kMs = 1'000'000;
  now_ns = 1'000 * kMs;
  define(definition(1, 1, "ball"));
  step();
  const auto say = [&](PoseSample sample, std::int64_t time_ns) {
    sample.source_time_ns = time_ns;
    sample.flags = wire_contract::kPosesStreamed;
    move(sample);
    step();
  };
  say(pose(0, {}), 1'100 * kMs);
  now_ns = 1'500 * kMs;
  step();
  say(pose(2, {{1, 6}}), 1'200 * kMs);
  EXPECT_EQ(world.newest()->posed_ns[slot_of(*world.find("ball"))], 1'200 * kMs);
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
