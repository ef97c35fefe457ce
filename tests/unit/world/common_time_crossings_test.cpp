// Generated crossings of two publishers' objects, beside the oracle.
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
