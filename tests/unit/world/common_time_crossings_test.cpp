// Generated crossings of two publishers' objects, compared with the oracle.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/oracle/meeting_oracle.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/world/standing_crossings.hpp"

namespace collided::engine {
namespace {

using OwnedBodies = std::vector<std::pair<std::size_t, MovingBody>>;

OwnedBodies random_crossing(std::mt19937_64& random, bool boxes) {
  OwnedBodies bodies;
  const double speed = std::exp(drawn(random, -3, 5));
  const double size = std::exp(drawn(random, -3, 0));
  for (std::size_t publisher = 0; publisher < 2; ++publisher) {
    const double period_ns = 1e9 / std::exp(drawn(random, std::log(5.0), std::log(240.0)));
    MovingBody body;
    if (boxes) body.form = Vec3(size * vector_drawn(random, 0.2, 1));
    else body.form = size * drawn(random, 0.2, 1);
    body.instants = random_flight(random, size, speed, period_ns);
    bodies.emplace_back(publisher, std::move(body));
  }
  return bodies;
}

std::vector<oracle::ToldMeeting> meetings_between(const Story& story, std::size_t a, std::size_t b) {
  const auto events = story.find("body" + std::to_string(a) + " body" + std::to_string(b));
  return meetings_of(events == story.end() ? std::vector<Told>() : events->second);
}

// In any order of arrival no contact is missed, none is invented, and brackets contain the times that the poses imply.
TEST(WorldCommonTime, GeneratedCrossingsAreReportedAsTheOracleFindsThem) {
  const int count = oracle::asked("COLLIDED_CROSSINGS", 2'000) / 2;
  for (const bool boxes : {false, true}) {
    std::mt19937_64 random = oracle::seeded(boxes ? 1802 : 1801);
    oracle::MeetingTally tally;
    for (int i = 0; i < count; ++i) {
      const OwnedBodies bodies = random_crossing(random, boxes);
      const Arrivals arrivals(bodies);
      const Story story = arrivals.tell(arrivals.shuffled(random), random, 0.5);
      oracle::compare(bodies[0].second, bodies[1].second, meetings_between(story, 0, 1), tally);
      ASSERT_EQ(tally.lies(), 0) << "crossing " << i << (boxes ? " of boxes: " : " of balls: ") << tally.missed
                                 << " missed, " << tally.invented << " invented, " << tally.wrong_brackets
                                 << " wrong brackets";
    }
    std::printf("%s=%d meetings=%d missed=%d invented=%d wrong_brackets=%d too_near=%d\n", boxes ? "boxes" : "balls",
                count, tally.meetings, tally.missed, tally.invented, tally.wrong_brackets, tally.too_near);
    EXPECT_GT(tally.meetings, count / 5) << "too few of the crossings meet";
    EXPECT_LT(tally.too_near, 10 + count / 100);
  }
}

/// The flushes of three publishers leave out some of their objects, which rest until the next flush. Neighbours meet:
/// balls mostly of one publisher, boxes of two, since only fast boxes are swept if they are of one flush.
OwnedBodies framed_crowd(std::mt19937_64& random, bool boxes) {
  const auto in = [&](double low, double high) { return drawn(random, low, high); };
  OwnedBodies bodies;
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
      if (boxes) body.form = vector_drawn(random, 0.1, 0.3);
      else body.form = in(0.1, 0.3);
      const Vec3 near = Vec3(100.0 * pair, 0, 0) + vector_drawn(random, -0.4, 0.4);
      const double speed = in(0.1, 3);
      const Vec3 velocity = vector_drawn(random, -speed, speed);
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

// An object that a flush left out has rested; its contacts with objects of its own publisher and of others are reported.
TEST(WorldCommonTime, WhatIsLeftOutOfFlushesMeetsAsTheOracleFindsIt) {
  const int count = oracle::asked("COLLIDED_CROSSINGS", 2'000) / 10;
  for (const bool boxes : {false, true}) {
    std::mt19937_64 random = oracle::seeded(boxes ? 1807 : 1806);
    oracle::MeetingTally tally;
    for (int i = 0; i < count; ++i) {
      const OwnedBodies bodies = framed_crowd(random, boxes);
      const Arrivals arrivals(bodies);
      const Story story = arrivals.tell(arrivals.shuffled(random), random, 0.5);
      for (std::size_t a = 0; a < bodies.size(); a += 2)
        oracle::compare(bodies[a].second, bodies[a + 1].second, meetings_between(story, a, a + 1), tally);
      ASSERT_EQ(tally.lies(), 0) << "crowd " << i << (boxes ? " of boxes: " : " of balls: ") << tally.missed
                                 << " missed, " << tally.invented << " invented, " << tally.wrong_brackets
                                 << " wrong brackets";
    }
    EXPECT_GT(tally.meetings, count / 2);
  }
}

// Arrival order, delays and steps make no difference: each pair's events are equal to the bit.
TEST(WorldCommonTime, AnyArrivalOrderReportsTheSameEvents) {
  const int orders = oracle::asked("COLLIDED_ORDERS", 20);
  std::mt19937_64 random = oracle::seeded(1803);
  std::size_t events = 0;
  for (int world = 0; world < 20; ++world) {
    OwnedBodies bodies;
    for (int i = 0; i < 3; ++i) {
      for (auto& [publisher, body] : random_crossing(random, false)) {
        bodies.emplace_back(publisher + 2 * static_cast<std::size_t>(i % 2), std::move(body));
      }
    }
    const Arrivals arrivals(bodies);
    const Story first = arrivals.tell(arrivals.shuffled(random), random, 1);
    for (const auto& [pair, told] : first) events += told.size();
    for (int order = 0; order < orders; ++order) {
      const Story again = arrivals.tell(arrivals.shuffled(random), random, 0.3);
      ASSERT_EQ(first.size(), again.size());
      for (const auto& [pair, told] : first) ASSERT_EQ(told, again.at(pair)) << pair << " in world " << world;
    }
  }
  std::printf("worlds=20 orders=%d events=%zu\n", orders, events);
  EXPECT_GT(events, 20u);
}

}  // namespace
}  // namespace collided::engine
