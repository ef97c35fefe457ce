// A standby takes the primary's place: it tells the newest events again, and a watch tells each once.
#include "client/library/watching/watch_state.hpp"

#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/service/wire/watch_model.hpp"
#include "tests/service/wire/watch_state_fixture.hpp"

namespace collided {
namespace {

using std::chrono::nanoseconds;

/// What happened in the world, which two servers work out alike, each with ids and numbers of its own.
struct Change {
  EventKind kind = EventKind::began;
  Pair pair;
  nanoseconds time{0};
};

HeardFrame dated(HeardFrame frame, nanoseconds time, nanoseconds stepped_after) {
  Event& event = frame.entries.front().event;
  event.world_time = time + stepped_after;
  event.bracket_low_s = event.bracket_high_s = std::chrono::duration<double>(stepped_after).count();
  return frame;
}

HeardBookmark dated(HeardBookmark bookmark, nanoseconds time) {
  bookmark.world_time = time;
  return bookmark;
}

HeardFrame told_by(Model& server, const Change& change, nanoseconds stepped_after) {
  switch (change.kind) {
    case EventKind::began: return dated(server.began(change.pair), change.time, stepped_after);
    case EventKind::contained:
      return dated(server.contained(change.pair, Containment::a_in_b), change.time, stepped_after);
    case EventKind::emerged: return dated(server.emerged(change.pair), change.time, stepped_after);
    default: return dated(server.ended(change.pair), change.time, stepped_after);
  }
}

std::string line_of(const Change& change) {
  return std::string(kWhat[static_cast<int>(change.kind)]) + ' ' + std::to_string(change.pair.first) + ' ' +
         std::to_string(change.pair.second);
}

/// Contacts that begin and end at random, some of which hold one within the other meanwhile.
std::vector<Change> changes(std::mt19937_64& random, std::size_t count) {
  constexpr std::uint64_t kPairs = 5;
  std::vector<int> states(kPairs, 0);  // 0 apart, 1 touching, 2 within
  std::vector<Change> made;
  nanoseconds time = std::chrono::hours(1);
  while (made.size() < count) {
    const std::uint64_t which = random() % kPairs;
    const Pair pair{2 * which + 1, 2 * which + 2};
    time += nanoseconds(1'000 + random() % 50'000'000);
    int& state = states[which];
    if (state == 0) {
      made.push_back({EventKind::began, pair, time});
      state = 1;
    } else if (state == 2) {
      made.push_back({EventKind::emerged, pair, time});
      state = 1;
    } else if (random() % 3 == 0) {
      made.push_back({EventKind::contained, pair, time});
      state = 2;
    } else {
      made.push_back({EventKind::ended, pair, time});
      state = 0;
    }
  }
  return made;
}

class WatchStateHeir : public WatchStateTest {
 protected:
  void hear_state_of(const Model& server, nanoseconds time) {
    for (std::uint8_t shard = 0; shard < wire_contract::kContactShards; ++shard) hear(server.shard(shard));
    hear(dated(server.bookmark(), time));
  }
};

TEST_F(WatchStateHeir, WhatIsToldAgainIsToldOnceWhereverThePrimaryBrokeOff) {
  const char* const given = std::getenv("COLLIDED_SEED");
  const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : 28;
  RecordProperty("seed", std::to_string(seed));
  SCOPED_TRACE("seed " + std::to_string(seed));
  for (std::uint64_t round = 0; round < 300; ++round) {
    std::mt19937_64 random(seed + round);
    const std::vector<Change> all = changes(random, 60);
    state_ = WatchState([this](const Event& event) { emit(event); });
    open_.clear();
    within_.clear();
    static_cast<void>(told());
    const std::size_t joins = random() % 20;
    const std::size_t breaks_off = joins + random() % 20;
    const std::size_t takes_over = breaks_off + random() % 10;
    const std::size_t again_from = random() % (joins + 1) / 2 + (random() % 2 == 0 ? 0 : joins / 2);
    const nanoseconds own_step(random() % 5'000'000), other_step(random() % 5'000'000);
    Model primary(1), heir(2, 2);
    std::vector<std::string> expected;
    for (std::size_t i = 0; i < breaks_off; ++i) {
      if (i == joins) {
        hear_state_of(primary, i == 0 ? all[0].time - nanoseconds(1'000) : all[i - 1].time + nanoseconds(10));
        static_cast<void>(told());  // what was open
      }
      const HeardFrame frame = told_by(primary, all[i], own_step);
      if (i >= joins) hear(frame);
      if (i >= joins) expected.push_back(line_of(all[i]));
    }
    if (breaks_off == joins) {
      hear_state_of(primary, joins == 0 ? all[0].time - nanoseconds(1'000) : all[joins - 1].time + nanoseconds(10));
      static_cast<void>(told());
    }
    for (std::size_t i = 0; i < takes_over; ++i) {
      HeardFrame frame = told_by(heir, all[i], other_step);
      frame.is_again = true;
      if (i >= again_from) hear(frame);
      if (i >= breaks_off) expected.push_back(line_of(all[i]));
    }
    hear_state_of(heir, all[takes_over].time - nanoseconds(500));
    EXPECT_TRUE(state_.in_step()) << "round " << round;
    for (std::size_t i = takes_over; i < all.size(); ++i) {
      hear(told_by(heir, all[i], other_step));
      expected.push_back(line_of(all[i]));
    }
    hear(dated(heir.bookmark(), all.back().time));
    EXPECT_TRUE(state_.in_step()) << "round " << round;
    // Nothing was missing, and the watch can tell from which event on it has heard the heir.
    EXPECT_EQ(state_.gaps(), 0U) << "round " << round;
    EXPECT_EQ(state_.life_change().changes, 1U);
    EXPECT_EQ(state_.life_change().heard_from, std::min(again_from, takes_over) + 1) << "round " << round;
    ASSERT_EQ(told(), expected) << "round " << round << ": joined at " << joins << ", broke off at " << breaks_off
                                << ", told again from " << again_from << ", taken over at " << takes_over;
  }
}

// An heir that tells nothing again, since nothing has happened, is heard from its next event on.
TEST_F(WatchStateHeir, ATakeoverInWhichNothingHappensIsNoGap) {
  Model primary(1), heir(2, 2);
  hear(primary.began({1, 2}));
  hear_state_of(primary, std::chrono::hours(1));
  for (int i = 0; i < 4; ++i) {
    heir.began({3, 4});
    heir.ended({3, 4});
  }
  heir.began({1, 2});
  hear_state_of(heir, std::chrono::hours(1));
  hear(heir.bookmark());
  EXPECT_TRUE(state_.in_step());
  hear(heir.ended({1, 2}));
  hear(heir.bookmark());
  EXPECT_EQ(told(), (Lines{"open 1 2 resync", "ended 1 2"}));
  EXPECT_EQ(state_.gaps(), 0U);
  EXPECT_EQ(state_.resyncs(), 1U);
  EXPECT_EQ(state_.life_change().before, (ServerLife{1, 1}));
  EXPECT_EQ(state_.life_change().now, (ServerLife{2, 2}));
  EXPECT_EQ(state_.life_change().heard_from, 10U) << "after its nine events of before";
}

// One of the events that it tells again was lost on the way, or a difference shows that something was.
TEST_F(WatchStateHeir, WhatIsMissingOfAnHeirIsAGap) {
  Model primary(1), heir(2, 2);
  hear_state_of(primary, std::chrono::hours(1));
  hear(heir.began({1, 2}));
  heir.ended({1, 2});
  hear(heir.began({3, 4}));
  EXPECT_EQ(state_.gaps(), 1U);
  hear_state_of(heir, std::chrono::hours(1));
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(state_.gaps(), 1U) << "once, however it is made up for";
  EXPECT_EQ(state_.life_change().heard_from, 1U);
  Model last(3, 3);
  last.began({3, 4});
  last.began({5, 6});
  hear_state_of(last, std::chrono::hours(1));
  hear(last.bookmark());
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(state_.gaps(), 2U) << "nobody told of the second contact";
  EXPECT_EQ(state_.life_change().changes, 2U);
}

// A primary that was stopped and goes on is not the heir of its heir.
TEST_F(WatchStateHeir, AnEarlierServerThatGoesOnIsNotHeardWhileItsHeirIsBriefly) {
  Model primary(1), heir(2, 2);
  hear(primary.bookmark());
  hear(primary.began({1, 2}));
  hear(heir.began({1, 2}));
  hear(heir.bookmark());
  static_cast<void>(told());
  pass(milliseconds(400));  // a machine with more to do than it can
  hear(primary.ended({1, 2}));
  hear(primary.bookmark());
  EXPECT_EQ(told(), Lines{});
  hear(heir.ended({1, 2}));
  EXPECT_EQ(told(), Lines{"ended 1 2"});
}

// As long as it has not told it, the heir has yet to work out what its predecessor told.
TEST_F(WatchStateHeir, AContactThatWasToldToHaveEndedDoesNotBeginAgainWhereTheHeirIsBehind) {
  const nanoseconds hour = std::chrono::hours(1);
  Model primary(1), heir(2, 2);
  hear(dated(primary.bookmark(), hour));
  hear(dated(primary.began({1, 2}), hour + milliseconds(10), nanoseconds(0)));
  hear(dated(primary.ended({1, 2}), hour + milliseconds(20), nanoseconds(0)));
  static_cast<void>(told());
  heir.began({1, 2});
  HeardShard shard = heir.shard({1, 2});
  shard.contacts.front().began = shard.contacts.front().world_time = hour + milliseconds(10);
  hear(shard);
  hear(dated(heir.bookmark(), hour + milliseconds(15)));
  EXPECT_EQ(told(), Lines{});
  hear(dated(heir.ended({1, 2}), hour + milliseconds(20), milliseconds(3)));
  hear(heir.shard({1, 2}));
  hear(dated(heir.bookmark(), hour + milliseconds(30)));
  EXPECT_EQ(told(), Lines{});
  EXPECT_TRUE(state_.in_step());
  hear(dated(heir.began({1, 2}), hour + milliseconds(40), nanoseconds(0)));
  EXPECT_EQ(told(), Lines{"began 1 2"});
}

}  // namespace
}  // namespace collided
