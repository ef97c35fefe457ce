// Watches over restarts, and with two servers that speak at once.
#include "client/library/watching/watch_state.hpp"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "tests/service/wire/watch_model.hpp"
#include "tests/service/wire/watch_state_fixture.hpp"

namespace collided {
namespace {

TEST_F(WatchStateTest, RestartEndsOnlyWhatNoLongerHolds) {
  Model first(1);
  hear(first.bookmark());
  hear(first.began({1, 2}));
  hear(first.began({3, 4}));
  hear(first.began({5, 6}));
  told();
  Model second(2);
  hear(second.bookmark(false));
  hear(second.began({1, 2}));  // holds still: nothing to tell
  hear(second.began({7, 8}));  // is new: told at once, not after the recovery
  EXPECT_EQ(told(), Lines{"began 7 8"});
  hear(second.bookmark(false));
  EXPECT_EQ(told(), Lines{}) << "until the server has recovered, absence says nothing";
  hear(second.began({5, 6}));
  hear(second.ended({5, 6}));
  EXPECT_EQ(told(), Lines{"ended 5 6"});
  hear(second.bookmark());
  EXPECT_EQ(told(), Lines{"ended 3 4 resync restarted"});
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(state_.resyncs(), 1u);
  hear(second.ended({1, 2}));
  EXPECT_EQ(told(), Lines{"ended 1 2"});
}

TEST_F(WatchStateTest, RestartMissedFromItsStartIsResyncedFromShards) {
  Model first(1);
  hear(first.bookmark());
  hear(first.began({1, 2}));
  hear(first.began({3, 4}));
  told();
  Model second(2);
  second.began({1, 2});
  second.began({5, 6});
  hear(second.shard({1, 2}));
  hear(second.shard({5, 6}));
  hear(second.bookmark());
  hear(second.bookmark());
  EXPECT_EQ(told(), (Lines{"began 5 6 resync", "ended 3 4 resync restarted"}));
}

TEST_F(WatchStateTest, WordsOfAnEarlierLifeAreIgnored) {
  Model old_life(1);
  Model new_life(2);
  hear(new_life.bookmark());
  hear(old_life.began({1, 2}));
  hear(old_life.bookmark());
  EXPECT_EQ(told(), Lines{});
  EXPECT_TRUE(state_.in_step());
}

// The server leaves names out of a shard that is too large to carry them; the frame that ends the contact has them.
TEST_F(WatchStateTest, AContactEndsUnderTheNamesItWasToldWith) {
  Model server(1);
  server.began({1, 2});
  HeardShard unnamed = server.shard({1, 2});
  unnamed.contacts.front().a = "71";
  unnamed.contacts.front().b = "72";
  for (int shard = 0; shard < static_cast<int>(wire_contract::kContactShards); ++shard) {
    hear(shard == unnamed.shard ? unnamed : server.shard(static_cast<std::uint8_t>(shard)));
  }
  hear(server.bookmark());
  state_.hear_persisted(server.persisted({1, 2}));
  hear(server.ended({1, 2}));
  EXPECT_EQ(told(), (Lines{"open 71 72 resync", "persisted 71 72", "ended 71 72"}));
  EXPECT_TRUE(state_.in_step());
}

// A clock that was set back between two lives gives the later one the smaller epoch.
TEST_F(WatchStateTest, SmallerEpochCountsOnceTheOtherIsSilent) {
  Model first(5);
  hear(first.bookmark());
  hear(first.began({1, 2}));
  told();
  pass(milliseconds(400));
  Model second(3);
  hear(second.bookmark());
  EXPECT_EQ(told(), Lines{}) << "it may be an earlier server that was stopped and goes on";
  pass(std::chrono::seconds(5));
  hear(second.bookmark());
  hear(second.bookmark());
  EXPECT_EQ(told(), Lines{"ended 1 2 resync restarted"});
}

// ---- peers that do odd things -------------------------------------------------------------------------------------------

// Shards come on a topic that sends the last value again to who joins: one that was sent before may come after.
TEST_F(WatchStateTest, AnOlderShardDoesNotReplaceANewerOne) {
  Model server(1);
  server.began({1, 2});
  const HeardShard older = server.shard({1, 2});
  server.ended({1, 2});
  hear(server.shard({1, 2}));
  hear(older);
  hear(server.bookmark());
  EXPECT_TRUE(state_.in_step()) << "what the newer one said holds";
  EXPECT_EQ(told(), Lines{});
}

TEST_F(WatchStateTest, AnOlderShardDoesNotHoldUpAResync) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  const HeardShard older = server.shard({1, 2});
  server.ended({1, 2});  // lost
  hear(server.began({3, 4}));
  hear(server.shard({1, 2}));
  hear(older);
  hear(server.bookmark());
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(told(), (Lines{"began 1 2", "began 3 4", "ended 1 2 resync"}));
}

TEST_F(WatchStateTest, ANewerShardReplacesAnOlderOneAndOneAgainChangesNothing) {
  Model server(1);
  server.began({1, 2});
  hear(server.shard({1, 2}));
  server.ended({1, 2});
  server.began({1, 2});
  hear(server.shard({1, 2}));
  hear(server.shard({1, 2}));
  hear(server.bookmark());
  EXPECT_EQ(told(), Lines{"open 1 2 resync"});
  hear(server.ended({1, 2}));
  EXPECT_EQ(told(), Lines{"ended 1 2"}) << "of the newer episode";
  EXPECT_EQ(state_.resyncs(), 0u);
}

TEST_F(WatchStateTest, AShardThatThereIsNotChangesNothing) {
  Model server(1);
  server.began({1, 2});
  for (const int number : {static_cast<int>(wire_contract::kContactShards), 255}) {
    HeardShard beyond = server.shard({1, 2});
    beyond.shard = static_cast<std::uint8_t>(number);
    beyond.as_of_sequence = ~std::uint64_t{0};
    hear(beyond);
  }
  hear(server.bookmark());
  EXPECT_FALSE(state_.in_step());
  hear(server.shard({1, 2}));
  EXPECT_EQ(told(), Lines{"open 1 2 resync"});
}

// Two servers on one namespace: while the one speaks, nothing of another that began no later is mixed in.
TEST_F(WatchStateTest, ASecondServersWordsAreNotMixedIn) {
  Model first(7);
  hear(first.bookmark());
  hear(first.began({1, 2}));
  for (Model second : {Model(7, 2), Model(5, 2), Model(5, 1)}) {
    hear(second.began({3, 4}));
    hear(second.shard({3, 4}));
    hear(second.bookmark());
    hear(second.bookmark());
    state_.hear_persisted(second.persisted({3, 4}));
    hear(second.ended({3, 4}));
  }
  Model twin(7, 2);  // of the same ids and numbers
  twin.began({1, 2});
  state_.hear_persisted(twin.persisted({1, 2}));
  EXPECT_EQ(told(), Lines{"began 1 2"});
  EXPECT_TRUE(state_.in_step());
  hear(first.bookmark());
  hear(first.ended({1, 2}));
  EXPECT_EQ(told(), Lines{"ended 1 2"});
  EXPECT_EQ(state_.resyncs(), 0u);
}

// One that began later is the first one's successor, whatever its number.
TEST_F(WatchStateTest, ALaterServerTakesOver) {
  Model first(7);
  hear(first.bookmark());
  hear(first.began({1, 2}));
  told();
  Model second(8, 2);
  hear(second.began({3, 4}));
  hear(second.bookmark());
  EXPECT_EQ(told(), (Lines{"began 3 4", "ended 1 2 resync restarted"}));
  hear(first.ended({1, 2}));
  EXPECT_EQ(told(), Lines{}) << "its words count no more";
}

TEST_F(WatchStateTest, AnotherServerCountsFromTheMomentTheFirstIsLost) {
  const std::chrono::nanoseconds lost(wire_contract::kStatusLostNs);
  Model first(7);
  Model second(7, 2);
  const Clock::time_point start = now_;
  state_.hear(first.bookmark(), start);
  state_.hear(second.bookmark(), start + lost);
  state_.hear(second.began({3, 4}), start + lost);
  EXPECT_EQ(told(), Lines{}) << "just not yet lost";
  // Whatever comes of it is a sign of life.
  Clock::time_point heard = start + lost;
  state_.hear(first.shard({1, 2}), heard);
  state_.hear(second.bookmark(), heard + lost);
  heard += lost;
  state_.hear(first.began({1, 2}), heard);
  state_.hear(second.bookmark(), heard + lost);
  heard += lost;
  state_.hear(first.bookmark(), heard);
  state_.hear(second.bookmark(), heard + lost);
  EXPECT_EQ(told(), Lines{"began 1 2"});
  EXPECT_EQ(state_.resyncs(), 0u);
  state_.hear(second.shard({3, 4}), heard + lost + std::chrono::nanoseconds(1));
  state_.hear(second.bookmark(), heard + lost + std::chrono::nanoseconds(2));
  state_.hear(second.bookmark(), heard + lost + std::chrono::nanoseconds(3));
  EXPECT_EQ(told(), (Lines{"began 3 4 resync", "ended 1 2 resync restarted"}));
}

// A pair that parts and meets again while nothing is heard is another contact: both are told, and the new one's end is its own.

TEST_F(WatchStateTest, AContactThatGoesOnOverARestartKeepsItsBeginning) {
  Model first(1);
  hear(first.bookmark());
  hear(with_numbers(first.began({1, 2}), 100));
  told();
  Model second(2);
  hear(second.bookmark(false));
  hear(redefined(with_numbers(second.began({1, 2}), 500), 2002, 2003, true));
  EXPECT_EQ(told(), Lines{});
  HeardFrame ended = redefined(with_numbers(second.ended({1, 2}), 600), 2002, 2003, true);
  hear(ended);
  EXPECT_EQ(events_.back().began, kFirstTouch);
  EXPECT_EQ(events_.back().world_time, std::chrono::seconds(602));
  EXPECT_EQ(events_.back().epoch, 2u);
  EXPECT_EQ(events_.back().a_id, 2002u);
  EXPECT_FALSE(events_.back().resync);
}

TEST_F(WatchStateTest, TwoRestartsInARowEndEachContactOnce) {
  Model first(1);
  hear(first.bookmark());
  hear(first.began({1, 2}));
  hear(first.began({3, 4}));
  Model second(2);
  hear(second.bookmark(false));
  hear(second.began({1, 2}));
  hear(second.began({5, 6}));
  told();
  Model third(3);
  hear(third.bookmark(false));
  hear(third.began({5, 6}));
  hear(third.bookmark());
  EXPECT_EQ(told(), (Lines{"ended 1 2 resync restarted", "ended 3 4 resync restarted"}));
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(open_, (std::set<Pair>{{5, 6}}));
}

/// A server that begins and ends at random, with a lossy, repeating, delaying line between.

}  // namespace
}  // namespace collided
