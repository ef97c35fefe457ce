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

namespace collided::engine {
namespace {

using oracle::Instant;
using oracle::MovingBody;

constexpr std::int64_t kStart = 1'000'000'000'000;
constexpr std::int64_t kMs = 1'000'000;

Shape shape_of(const MovingBody& body) {
  Shape shape;
  if (const double* radius = std::get_if<double>(&body.form)) {
    shape.primitives.emplace_back(Sphere{Vec3::Zero(), *radius});
  } else {
    shape.primitives.emplace_back(Box{.center = Vec3::Zero(), .half_m = std::get<Vec3>(body.form)});
  }
  return shape;
}

/// An event as a subscriber knows it, in the publishers' time.
struct Told {
  EventKind kind = EventKind::began;
  EndReason reason = EndReason::none;
  std::int64_t low_ns = 0;
  std::int64_t high_ns = 0;
  std::uint64_t depth_bits = 0;
  std::array<std::uint64_t, 3> velocity_bits{};
  bool operator==(const Told&) const = default;
};

using Story = std::map<std::string, std::vector<Told>>;  // by pair

/// Publishers' batches as they come to the engine; publisher k has the bodies with owner k.
class Arrivals {
 public:
  explicit Arrivals(std::vector<std::pair<std::size_t, MovingBody>> bodies, bool streamed = false)
      : bodies_(std::move(bodies)), streamed_(streamed) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      for (const Instant& instant : bodies_[i].second.instants)
        batches_[bodies_[i].first][instant.time_ns].push_back(i);
    }
  }

  std::vector<std::size_t> publishers() const {
    std::vector<std::size_t> all;
    for (const auto& [publisher, batches] : batches_) all.insert(all.end(), batches.size(), publisher);
    return all;
  }

  /// order: whose next batch comes; a step after a batch where the generator says so, and where an object would move twice.
  Story tell(const std::vector<std::size_t>& order, std::mt19937_64& random, double step_chance) {
    World world{WorldOptions{}};
    std::vector<ObjectId> ids;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      ObjectDefinition definition;
      definition.name = "body" + std::to_string(i);
      definition.shape = shape_of(bodies_[i].second);
      definition.publisher = bodies_[i].first + 1;
      definition.pose.position = bodies_[i].second.instants.front().position;
      ids.push_back(std::get<ObjectId>(world.define(definition)));
    }
    Story story;
    std::int64_t now_ns = kStart;
    const auto step = [&] {
      EXPECT_TRUE(world.step(++now_ns, 1, {}));
      for (const Event& event : world.events()) note(world, event, now_ns, story);
    };
    step();
    std::map<std::size_t, std::map<std::int64_t, std::vector<std::size_t>>::const_iterator> next;
    for (const auto& [publisher, batches] : batches_) next[publisher] = batches.begin();
    for (const std::size_t publisher : order) {
      const auto& [time_ns, members] = *next[publisher]++;
      if (std::any_of(members.begin(), members.end(), [&](std::size_t i) { return world.has_moved(ids[i]); })) step();
      give(world, ids, publisher, time_ns, members);
      if (std::bernoulli_distribution(step_chance)(random)) step();
    }
    step();
    return story;
  }

 private:
  void give(World& world, const std::vector<ObjectId>& ids, std::size_t publisher, std::int64_t time_ns,
            const std::vector<std::size_t>& members) {
    std::vector<ObjectId> moved_ids;
    std::vector<Pose> poses;
    for (const std::size_t i : members) {
      const auto& instants = bodies_[i].second.instants;
      const auto at =
          std::find_if(instants.begin(), instants.end(), [&](const Instant& x) { return x.time_ns == time_ns; });
      // Who rests may be left out.
      if (at != instants.begin() && at->position == std::prev(at)->position) continue;
      moved_ids.push_back(ids[i]);
      poses.push_back({.position = at->position});
    }
    std::array<bool, 64> moved{};
    world.move(moved_ids, poses, time_ns, false, std::span(moved).first(moved_ids.size()), streamed_);
    world.advance(publisher + 1, time_ns);
  }

  static void note(const World& world, const Event& event, std::int64_t now_ns, Story& story) {
    const auto time = [&](double seconds_ago) { return now_ns - std::llround(seconds_ago * 1e9); };
    Told told{.kind = event.kind,
              .reason = event.reason,
              .low_ns = time(event.bracket_low_s),
              .high_ns = time(event.bracket_high_s)};
    told.depth_bits = std::bit_cast<std::uint64_t>(event.of.contact.depth_m);
    for (int k = 0; k < 3; ++k) {
      told.velocity_bits[static_cast<std::size_t>(k)] = std::bit_cast<std::uint64_t>(event.relative_velocity[k] + 0.0);
    }
    story[world.info(event.of.a)->name + " " + world.info(event.of.b)->name].push_back(told);
  }

  std::vector<std::pair<std::size_t, MovingBody>> bodies_;
  bool streamed_;
  std::map<std::size_t, std::map<std::int64_t, std::vector<std::size_t>>> batches_;  // by publisher, by time
};

/// Straight through `at` with that velocity (m/s) at `through_ns`, posed every period from kStart + phase.
MovingBody flight(double radius_m, const Vec3& at, const Vec3& velocity, std::int64_t through_ns, std::int64_t phase_ns,
                  std::int64_t period_ns, int count) {
  MovingBody body{.form = radius_m, .instants = {}};
  for (int i = 0; i < count; ++i) {
    const std::int64_t time_ns = kStart + phase_ns + i * period_ns;
    body.instants.push_back({time_ns, at + velocity * (1e-9 * static_cast<double>(time_ns - through_ns))});
  }
  return body;
}

std::vector<Told> only_story(const Story& story) {
  EXPECT_EQ(story.size(), 1u);
  return story.empty() ? std::vector<Told>() : story.begin()->second;
}

Story two_flights(const MovingBody& a, const MovingBody& b, double step_chance = 1) {
  Arrivals arrivals({{0, a}, {1, b}});
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < a.instants.size(); ++i) order.insert(order.end(), {0, 1});
  std::mt19937_64 random(1);
  return arrivals.tell(order, random, step_chance);
}

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
                      true);
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
struct Crossing {
  std::vector<std::pair<std::size_t, MovingBody>> bodies;
};

Crossing random_crossing(std::mt19937_64& random, bool boxes) {
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const auto vector = [&](double size) { return Vec3(in(-size, size), in(-size, size), in(-size, size)); };
  Crossing crossing;
  const double speed = std::exp(in(-3, 5));
  const double size = std::exp(in(-3, 0));
  for (std::size_t publisher = 0; publisher < 2; ++publisher) {
    const double period_ns = 1e9 / std::exp(in(std::log(5.0), std::log(240.0)));
    MovingBody body;
    if (boxes) body.form = Vec3(size * in(0.2, 1), size * in(0.2, 1), size * in(0.2, 1));
    else body.form = size * in(0.2, 1);
    const Vec3 summand = vector(1.2 * size);
    const Vec3 velocity = vector(speed);
    const Vec3 bend = vector(0.3 * speed);
    // Steps that pass until both have said something take less than a thousand nanoseconds of the world's own time.
    body.instants.push_back({kStart + 1'000, summand + velocity * -0.25 + bend * 0.25});
    double time_ns = 2'000 + in(0, period_ns);
    while (time_ns < 0.5e9 || body.instants.size() < 2) {
      const double s = 1e-9 * time_ns - 0.25;
      body.instants.push_back(
          {kStart + static_cast<std::int64_t>(time_ns), summand + velocity * s + bend * std::abs(s)});
      time_ns += period_ns * in(0.7, 1.3);
    }
    crossing.bodies.emplace_back(publisher, std::move(body));
  }
  return crossing;
}

/// Each began with the ended behind it.
std::vector<oracle::ToldMeeting> meetings_of(const Story& story) {
  std::vector<oracle::ToldMeeting> told;
  if (story.empty()) return told;
  for (const Told& event : story.begin()->second) {
    if (event.kind == EventKind::began) told.push_back({.began = {event.low_ns, event.high_ns}, .ended = {}});
    else told.back().ended = {event.low_ns, event.high_ns};
  }
  return told;
}

std::vector<std::size_t> shuffled(std::vector<std::size_t> order, std::mt19937_64& random) {
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

/// As many as are asked for by that variable of the environment, for the long form of a test; else the given number.
int asked(const char* variable, int fallback) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::atoi(text) : fallback;
}

// Whatever comes when: no contact is missed, none is invented, and brackets contain what the poses say.
TEST(WorldCommonTime, GeneratedCrossingsAreToldAsTheOracleFindsThem) {
  const int count = asked("COLLIDED_CROSSINGS", 2'000) / 2;
  for (const bool boxes : {false, true}) {
    std::mt19937_64 random = oracle::seeded(boxes ? 1802 : 1801);
    oracle::MeetingTally tally;
    for (int i = 0; i < count; ++i) {
      const Crossing crossing = random_crossing(random, boxes);
      Arrivals arrivals(crossing.bodies);
      const Story story = arrivals.tell(shuffled(arrivals.publishers(), random), random, 0.5);
      oracle::compare(crossing.bodies[0].second, crossing.bodies[1].second, meetings_of(story), tally);
      ASSERT_EQ(tally.lies(), 0) << "crossing " << i << (boxes ? " of boxes: " : " of balls: ") << tally.missed
                                 << " missed, " << tally.invented << " invented, " << tally.wrong_brackets
                                 << " brackets beside the truth";
    }
    std::printf("%s=%d meetings=%d missed=%d invented=%d wrong_brackets=%d too_near=%d\n", boxes ? "boxes" : "balls",
                count, tally.meetings, tally.missed, tally.invented, tally.wrong_brackets, tally.too_near);
    EXPECT_GT(tally.meetings, count / 5) << "crossings must be worth it";
    EXPECT_LT(tally.too_near, 10 + count / 100);
  }
}

/// Framed: three publishers' flushes leave out some of their objects, which rest until the next. Neighbours meet: balls mostly
/// of one publisher; boxes of two, since of those of one flush only what is fast is swept.
std::vector<std::pair<std::size_t, MovingBody>> framed_crowd(std::mt19937_64& random, bool boxes) {
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const auto vector = [&](double size) { return Vec3(in(-size, size), in(-size, size), in(-size, size)); };
  std::vector<std::pair<std::size_t, MovingBody>> bodies;
  std::array<std::vector<std::int64_t>, 3> stamps;
  for (auto& all : stamps) {
    const double period_ns = 1e9 / std::exp(in(std::log(5.0), std::log(60.0)));
    all = {kStart + 1'000};
    for (double time_ns = 2'000 + in(0, period_ns); time_ns < 1e9; time_ns += period_ns * in(0.7, 1.3)) {
      all.push_back(kStart + static_cast<std::int64_t>(time_ns));
    }
    all.push_back(kStart + 1'000'000'000);
  }
  for (int pair = 0; pair < 4; ++pair) {
    const std::size_t first = random() % 3;
    for (const std::size_t publisher : {first, !boxes && in(0, 1) < 0.7 ? first : (first + 1) % 3}) {
      MovingBody body;
      if (boxes) body.form = Vec3(in(0.1, 0.3), in(0.1, 0.3), in(0.1, 0.3));
      else body.form = in(0.1, 0.3);
      const Vec3 near = Vec3(100.0 * pair, 0, 0) + vector(0.4);
      const Vec3 velocity = vector(in(0.1, 3));
      for (const std::int64_t stamp : stamps[publisher]) {
        const bool is_left_out = !body.instants.empty() && stamp < stamps[publisher].back() && in(0, 1) < 0.25;
        const Vec3 at = is_left_out ? body.instants.back().position
                                    : near + velocity * (1e-9 * static_cast<double>(stamp - kStart) - 0.5);
        body.instants.push_back({stamp, at});
      }
      bodies.emplace_back(publisher, std::move(body));
    }
  }
  return bodies;
}

// Whom a flush left out has rested; it meets whom it meets all the same, of its own publisher and of others.
TEST(WorldCommonTime, WhatIsLeftOutOfFlushesMeetsAsTheOracleFindsIt) {
  const int count = asked("COLLIDED_CROSSINGS", 2'000) / 10;
  for (const bool boxes : {false, true}) {
    std::mt19937_64 random = oracle::seeded(boxes ? 1807 : 1806);
    oracle::MeetingTally tally;
    for (int i = 0; i < count; ++i) {
      const auto bodies = framed_crowd(random, boxes);
      Arrivals arrivals(bodies);
      const Story story = arrivals.tell(shuffled(arrivals.publishers(), random), random, 0.5);
      for (std::size_t a = 0; a < bodies.size(); a += 2) {
        const auto told = story.find("body" + std::to_string(a) + " body" + std::to_string(a + 1));
        oracle::compare(bodies[a].second, bodies[a + 1].second,
                        told == story.end() ? std::vector<oracle::ToldMeeting>() : meetings_of(Story{*told}), tally);
      }
      ASSERT_EQ(tally.lies(), 0) << "crowd " << i << (boxes ? " of boxes: " : " of balls: ") << tally.missed
                                 << " missed, " << tally.invented << " invented, " << tally.wrong_brackets
                                 << " brackets beside the truth";
    }
    EXPECT_GT(tally.meetings, count / 2);
  }
}

// Arrival order, delays and steps do not show: each pair's events are equal to the bit.
TEST(WorldCommonTime, AnyArrivalOrderTellsTheSameEvents) {
  const int orders = asked("COLLIDED_ORDERS", 20);
  std::mt19937_64 random = oracle::seeded(1803);
  std::size_t events = 0;
  for (int world = 0; world < 20; ++world) {
    std::vector<std::pair<std::size_t, MovingBody>> bodies;
    for (int i = 0; i < 3; ++i) {
      for (auto& [publisher, body] : random_crossing(random, false).bodies) {
        bodies.emplace_back(publisher + 2 * static_cast<std::size_t>(i % 2), std::move(body));
      }
    }
    Arrivals arrivals(bodies);
    const Story first = arrivals.tell(shuffled(arrivals.publishers(), random), random, 1);
    for (const auto& [pair, told] : first) events += told.size();
    for (int order = 0; order < orders; ++order) {
      const Story again = arrivals.tell(shuffled(arrivals.publishers(), random), random, 0.3);
      ASSERT_EQ(first.size(), again.size());
      for (const auto& [pair, told] : first) ASSERT_EQ(told, again.at(pair)) << pair << " in world " << world;
    }
  }
  std::printf("worlds=20 orders=%d events=%zu\n", orders, events);
  EXPECT_GT(events, 20u);
}

}  // namespace
}  // namespace collided::engine
