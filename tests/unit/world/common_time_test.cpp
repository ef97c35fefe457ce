// Movers of several publishers, each with its own instants: their events come from their poses alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "server/world/world.hpp"
#include "tests/oracle/meeting_oracle.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/world/common_time_arrivals.hpp"

namespace collided::engine {
namespace {

// Two balls of 0.1 m at 200 m/s whose centres coincide at one instant, by a publisher each: in step, and 2 ms apart.
TEST(WorldCommonTime, TwoPublishersBallsThatMeetBetweenTheirPosesAreTold) {
  for (const std::int64_t apart_ns : {std::int64_t{0}, 2 * kMs, 5 * kMs, 9 * kMs}) {
    const std::int64_t meet_ns = kStart + 105 * kMs;
    const std::vector<Told> told =
        only_story(two_flights(flight(0.1, {0, 0, 50}, {200, 0, 0}, meet_ns, 0, 10 * kMs, 21),
                               flight(0.1, {0, 0, 50}, {0, 200, 0}, meet_ns, apart_ns, 10 * kMs, 21)));
    ASSERT_EQ(told.size(), 2u) << apart_ns;
    EXPECT_EQ(told[0].kind, EventKind::began);
    EXPECT_EQ(told[1].kind, EventKind::ended);
    EXPECT_EQ(told[1].reason, EndReason::separated);
    // Their distance is 200 sqrt(2) t: 0.2 m at 0.7071 ms on either side.
    const double half_ns = 0.2 / (200 * std::sqrt(2)) * 1e9;
    EXPECT_NEAR(static_cast<double>(told[0].high_ns - meet_ns), -half_ns, 3) << apart_ns;
    EXPECT_NEAR(static_cast<double>(told[1].low_ns - meet_ns), half_ns, 3) << apart_ns;
    EXPECT_LE(told[0].high_ns - told[0].low_ns, 3);
    EXPECT_LE(told[1].high_ns - told[1].low_ns, 3);
  }
}

// The same, but the second passes 0.42 m behind the first.
TEST(WorldCommonTime, TwoPublishersBallsThatPassEachOtherAreNotTold) {
  for (const std::int64_t apart_ns : {std::int64_t{0}, 2 * kMs, 5 * kMs}) {
    const std::int64_t meet_ns = kStart + 105 * kMs;
    const Story story = two_flights(flight(0.1, {0, 0, 50}, {200, 0, 0}, meet_ns, 0, 10 * kMs, 21),
                                    flight(0.1, {0, 0.6, 50}, {0, 200, 0}, meet_ns, apart_ns, 10 * kMs, 21));
    EXPECT_TRUE(story.empty()) << apart_ns;
  }
}

// What one publisher streams in batches of their own, each object at instants of its own.
TEST(WorldCommonTime, OnePublishersStreamedObjectsMoveBetweenTheirOwnPoses) {
  const std::int64_t meet_ns = kStart + 105 * kMs;
  for (const double beside_m : {0.0, 0.6}) {
    Arrivals arrivals({{0, flight(0.1, {0, 0, 50}, {200, 0, 0}, meet_ns, 0, 10 * kMs, 21)},
                       {0, flight(0.1, {0, beside_m, 50}, {0, 200, 0}, meet_ns, 2 * kMs, 10 * kMs, 21)}},
                      {.is_streamed = true});
    std::mt19937_64 random(1);
    const Story story = arrivals.tell(std::vector<std::size_t>(42, 0), random, 0.5);
    EXPECT_EQ(story.size(), beside_m == 0 ? 1u : 0u);
  }
}

// 4 m/s whatever the phase between the two.
TEST(WorldCommonTime, RelativeVelocityIsThatOfTheContact) {
  const std::int64_t meet_ns = kStart + 105 * kMs;
  for (const std::int64_t apart_ns : {std::int64_t{0}, 3 * kMs}) {
    const std::vector<Told> told =
        only_story(two_flights(flight(0.3, {0, 0, 5}, {2, 0, 0}, meet_ns, 0, 10 * kMs, 21),
                               flight(0.3, {0.4, 0, 5}, {-2, 0, 0}, meet_ns, apart_ns, 10 * kMs, 21)));
    ASSERT_FALSE(told.empty());
    EXPECT_NEAR(std::bit_cast<double>(told[0].velocity_bits[0]), -4, 1e-9);
  }
}

/// A world in which each object is named by its number, for stories that the generator does not tell.
class Stage {
 public:
  explicit Stage(const WorldOptions& options = {}) : world(options) { step(); }
  std::size_t ball(std::uint64_t publisher, const Vec3& at) {
    ObjectDefinition definition;
    definition.name = "ball" + std::to_string(ids_.size());
    definition.shape.primitives.emplace_back(Sphere{Vec3::Zero(), 0.5});
    definition.publisher = publisher;
    definition.pose.position = at;
    ids_.push_back(std::get<ObjectId>(world.define(definition)));
    return ids_.size() - 1;
  }
  void move(std::size_t ball, std::int64_t ms, const Vec3& to, bool teleport = false) {
    EXPECT_TRUE(world.move(ids_[ball], {.position = to}, kStart + ms * kMs, teleport));
  }
  void advance(std::uint64_t publisher, std::int64_t ms) { world.advance(publisher, kStart + ms * kMs); }
  void live(std::uint64_t publisher, std::int64_t ms) { world.advance(publisher, kStart + ms * kMs, true); }
  const std::vector<Event>& step() {
    EXPECT_TRUE(world.step(++now_ns_, 1, {}));
    return world.events();
  }
  /// Milliseconds after the start at the end of the event's bracket.
  double ms_of(const Event& event) const {
    return 1e-6 * (static_cast<double>(now_ns_ - kStart) - event.bracket_high_s * 1e9);
  }
  World world;

 private:
  std::vector<ObjectId> ids_;
  std::int64_t now_ns_ = kStart;
};

// A ball of the first publisher goes through one of the second and one of its own, and is put back.
TEST(WorldCommonTime, AnErrorOfClocksWidensBracketsBetweenPublishersAndNothingElse) {
  constexpr std::int64_t kErrorNs = 3 * kMs;
  const auto told = [](std::int64_t error_ns) {
    Stage stage(WorldOptions{.clock_error_ns = error_ns});
    const std::size_t mover = stage.ball(1, {0, 0, 0});
    stage.ball(2, {20, 0, 0});
    stage.ball(1, {30, 0, 0});
    std::vector<Event> events;
    const auto step = [&](std::int64_t ms) {
      stage.advance(1, ms);
      stage.advance(2, ms);
      for (const Event& event : stage.step()) events.push_back(event);
    };
    step(10);
    stage.move(mover, 20, {20.25, 0, 0});
    step(20);
    stage.move(mover, 30, {0, 9, 0}, true);
    step(30);
    stage.move(mover, 40, {30.25, 0, 0});
    step(40);
    return events;
  };
  const std::vector<Event> plain = told(0), widened = told(kErrorNs);
  ASSERT_EQ(plain.size(), 3u) << "began on the way, was parted by a jump, began with its own";
  ASSERT_EQ(widened.size(), plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const double error_s = i < 2 ? 1e-9 * kErrorNs : 0;
    EXPECT_EQ(widened[i].kind, plain[i].kind);
    EXPECT_EQ(widened[i].of.a, plain[i].of.a);
    EXPECT_EQ(widened[i].of.b, plain[i].of.b);
    EXPECT_NEAR(widened[i].bracket_low_s, plain[i].bracket_low_s + error_s, 1e-12) << i;
    EXPECT_NEAR(widened[i].bracket_high_s, plain[i].bracket_high_s - error_s, 1e-12) << i;
    EXPECT_EQ(widened[i].of.contact.depth_m, plain[i].of.contact.depth_m);
    EXPECT_EQ(widened[i].relative_velocity, plain[i].relative_velocity);
  }
}

// Left out for 90 ms, it went its 100 m in the last ten: it comes to what stands in the middle at 95 ms, not at 50.
TEST(WorldCommonTime, WhoIsLeftOutOfAnInstantHasRested) {
  Stage stage;
  const std::size_t mover = stage.ball(1, {0, 0, 0});
  stage.ball(2, {51, 0, 0});
  for (int ms = 10; ms <= 90; ms += 10) {
    stage.advance(1, ms);
    stage.advance(2, ms);
    EXPECT_TRUE(stage.step().empty()) << ms;
  }
  stage.move(mover, 100, {100, 0, 0});
  stage.advance(1, 100);
  stage.advance(2, 100);
  ASSERT_EQ(stage.step().size(), 2u);
  EXPECT_NEAR(stage.ms_of(stage.world.events()[0]), 95, 1e-5) << "its side touches after 50 m";
}

// Two publishers at 1 Hz, half a second apart, whose balls pass through the origin at 3.25 s at 4 m/s. Between their poses both
// say again and again that they live.
TEST(WorldCommonTime, BetweenPosesWithinTheGapAnObjectGoesStraightWhateverSignsOfLifeCome) {
  Stage stage;
  const std::size_t along_x = stage.ball(1, {-13, 0, 0});
  const std::size_t along_y = stage.ball(2, {0, -11, 0});
  std::vector<double> began_ms;
  for (int ms = 0; ms <= 5'500; ms += 100) {
    const double way_m = 4 * (1e-3 * ms - 3.25);
    if (ms % 1'000 == 0) stage.move(along_x, ms, {way_m, 0, 0});
    if (ms % 1'000 == 0) stage.advance(1, ms);
    else stage.live(1, ms);
    if (ms % 1'000 == 500) stage.move(along_y, ms, {0, way_m, 0});
    if (ms % 1'000 == 500) stage.advance(2, ms);
    else stage.live(2, ms);
    for (const Event& event : stage.step()) {
      if (event.kind == EventKind::began) began_ms.push_back(stage.ms_of(event));
    }
  }
  ASSERT_EQ(began_ms.size(), 1u);
  EXPECT_NEAR(began_ms[0], 3'250 - 1e3 / (4 * std::sqrt(2)), 1e-5);
}

// Ten seconds at rest, and then 30 m in the last second and a half.
TEST(WorldCommonTime, BeyondTheGapAnObjectRestedUntilOneGapBeforeItsNextPose) {
  for (const std::int64_t gap_ms : {1'500, 250, 4'000}) {
    Stage stage;
    if (gap_ms != 1'500) stage.world.set_gap(1, gap_ms * kMs);
    const std::size_t mover = stage.ball(1, {0, 0, 0});
    stage.ball(2, {16, 0, 0});
    for (const std::uint64_t publisher : {1, 2}) stage.advance(publisher, 0);
    stage.step();
    stage.move(mover, 10'000, {30, 0, 0});
    for (const std::uint64_t publisher : {1, 2}) stage.advance(publisher, 10'000);
    ASSERT_EQ(stage.step().size(), 2u);
    EXPECT_NEAR(stage.ms_of(stage.world.events()[0]), 10'000 - static_cast<double>(gap_ms) / 2, 1e-5)
        << "its side touches after 15 m";
  }
}

// The first only says that it lives: it may have moved for as long as a gap.
TEST(WorldCommonTime, ASilentPublishersPairsWaitNoLongerThanItsGap) {
  Stage stage;
  stage.ball(1, {0, 0, 0});
  const std::size_t mover = stage.ball(2, {9, 0, 0});
  for (const std::uint64_t publisher : {1, 2}) stage.advance(publisher, 0);
  stage.step();
  stage.move(mover, 100, {0.5, 0, 0});
  stage.advance(2, 100);
  for (int ms = 100; ms < 1'600; ms += 100) {
    stage.live(1, ms);
    EXPECT_TRUE(stage.step().empty()) << ms;
  }
  stage.live(1, 1'600);
  EXPECT_EQ(stage.step().size(), 1u);
}

// What one publisher has not said yet keeps nobody else waiting; when it is lost, what it had rests.
TEST(WorldCommonTime, ASilentPublisherDelaysItsOwnPairsOnly) {
  Stage stage;
  const std::size_t mover = stage.ball(1, {0, 0, 0});
  stage.ball(2, {20, 0, 0});
  stage.ball(3, {20, 0, 0.75});
  for (const std::uint64_t publisher : {1, 2, 3}) stage.advance(publisher, 10);
  EXPECT_EQ(stage.step().size(), 1u) << "the two that stand together";
  stage.move(mover, 20, {20, 0, 0});
  stage.advance(1, 20);
  EXPECT_TRUE(stage.step().empty()) << "where the second is at 20 ms is not known";
  stage.advance(2, 20);
  ASSERT_EQ(stage.step().size(), 1u);
  EXPECT_EQ(stage.world.info(stage.world.events()[0].of.b)->name, "ball1");
  stage.world.lose(3);
  ASSERT_EQ(stage.step().size(), 0u) << "the server's own time is not there yet";
}

// A jump is no way: what stands between is not met, what is left behind is parted from at that instant.
TEST(WorldCommonTime, AJumpPartsAtItsInstant) {
  Stage stage;
  const std::size_t jumper = stage.ball(1, {0, 0, 0});
  stage.ball(2, {0.5, 0, 0});
  stage.ball(2, {50, 0, 0});
  stage.advance(1, 10);
  stage.advance(2, 10);
  EXPECT_EQ(stage.step().size(), 1u);
  stage.move(jumper, 20, {100, 0, 0}, true);
  stage.advance(1, 20);
  stage.advance(2, 30);
  ASSERT_EQ(stage.step().size(), 1u);
  EXPECT_EQ(stage.world.events()[0].reason, EndReason::teleported);
  EXPECT_NEAR(stage.ms_of(stage.world.events()[0]), 20, 1e-6);
}

// The same stamp twice, or one that goes back: the way there is looked at all the same.
TEST(WorldCommonTime, AnInstantThatComesAgainIsTheNextNanosecond) {
  Stage stage;
  const std::size_t mover = stage.ball(1, {0, 0, 0});
  stage.ball(2, {20, 0, 0});
  stage.advance(1, 10);
  stage.advance(2, 10);
  stage.advance(2, 30);
  EXPECT_TRUE(stage.step().empty());
  stage.move(mover, 10, {40, 0, 0});
  stage.advance(1, 10);
  EXPECT_EQ(stage.step().size(), 2u) << "through the other";
}

// Its clock is behind the server's: what it defines and stamps within one step is there from its own instant on, and touches.
TEST(WorldCommonTime, WhatIsNewTouchesThoughItsPublishersInstantLiesBeforeTheStep) {
  for (const std::uint64_t other : {1, 2}) {
    Stage stage;
    stage.world.step(kStart + 100 * kMs, 1, {});
    stage.ball(1, {0, 0, 0});
    stage.ball(other, {0.5, 0, 0});
    stage.advance(1, 50);
    stage.advance(2, 60);
    stage.world.step(kStart + 101 * kMs, 1, {});
    stage.advance(1, 70);
    stage.world.step(kStart + 111 * kMs, 1, {});
    EXPECT_EQ(stage.world.contacts().size(), 1u) << "of publishers 1 and " << other;
  }
}

// The server shows it at 100 ms; its publisher says 40, then 90, then 140, and nothing moves.
TEST(WorldCommonTime, WhatNobodyCouldDecideWhenItCameIsDecidedLater) {
  Stage stage;
  stage.ball(1, {0, 0, 0});
  stage.advance(1, 40);
  stage.world.step(kStart + 50 * kMs, 1, {});
  stage.ball(2, {0.5, 0, 0});
  stage.world.step(kStart + 100 * kMs, 1, {});
  EXPECT_TRUE(stage.world.contacts().empty()) << "where the first is at 100 ms is not known";
  for (const int ms : {90, 140}) {
    stage.advance(1, ms);
    stage.world.step(kStart + (ms + 20) * kMs, 1, {});
  }
  EXPECT_EQ(stage.world.contacts().size(), 1u);
}

// A way that the other's publisher had not said yet where it was: both fall silent, and from then on they are known all the same.
TEST(WorldCommonTime, AWayThatWasOwedWhenBothWereLostIsDecided) {
  Stage stage;
  const std::size_t mover = stage.ball(1, {0, 0, 0});
  stage.ball(2, {20, 0, 0});
  stage.advance(1, 10);
  stage.advance(2, 10);
  stage.world.step(kStart + 20 * kMs, 1, {});
  stage.move(mover, 20, {40, 0, 0});
  stage.advance(1, 20);
  stage.world.step(kStart + 30 * kMs, 1, {});
  EXPECT_TRUE(stage.world.events().empty());
  stage.world.lose(1);
  stage.world.lose(2);
  stage.world.step(kStart + 40 * kMs, 1, {});
  ASSERT_EQ(stage.world.events().size(), 2u) << "through the other";
}

// Alone it goes on at its own time: a publisher whose partner has gone owes nobody anything, and its own contacts are told.
TEST(WorldCommonTime, WhatIsNewTouchesWhileItsPublisherIsTheOnlyOne) {
  Stage stage;
  stage.world.step(kStart + 100 * kMs, 1, {});
  stage.ball(1, {0, 0, 0});
  stage.ball(1, {0.5, 0, 0});
  stage.world.step(kStart + 101 * kMs, 1, {});
  EXPECT_EQ(stage.world.contacts().size(), 1u);
  stage.advance(1, 60);
  stage.ball(1, {-0.5, 0, 0});
  stage.world.step(kStart + 102 * kMs, 1, {});
  EXPECT_EQ(stage.world.contacts().size(), 3u) << "the third touches both";
}

/// Rates from 1 to 240 Hz, phases, jitter, turns of the way, objects of several sizes; most meet near the middle.

}  // namespace
}  // namespace collided::engine
