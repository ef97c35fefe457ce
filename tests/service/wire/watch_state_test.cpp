// Contacts from shards, events and bookmarks; gaps in their order.
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

TEST_F(WatchStateTest, EmptyWorldIsInStepAtTheFirstBookmark) {
  Model server(1);
  hear(server.bookmark());
  EXPECT_TRUE(state_.in_step());
  hear(server.began({1, 2}));
  hear(server.ended({1, 2}));
  EXPECT_EQ(told(), (Lines{"began 1 2", "ended 1 2"}));
  EXPECT_EQ(state_.resyncs(), 0u);
}

// They travel without a count, so one may come before its began or after its ended.
TEST_F(WatchStateTest, PersistedIsToldBetweenBeganAndEndedOnly) {
  Model server(1);
  hear(server.bookmark());
  const HeardFrame began = server.began({1, 2});
  const HeardFrame persisted = server.persisted({1, 2});
  state_.hear_persisted(persisted);
  hear(began);
  state_.hear_persisted(persisted);
  hear(server.ended({1, 2}));
  state_.hear_persisted(persisted);
  hear(server.began({1, 2}));
  state_.hear_persisted(persisted);  // of the episode before
  EXPECT_EQ(told(), (Lines{"began 1 2", "persisted 1 2", "ended 1 2", "began 1 2"}));
  EXPECT_EQ(state_.resyncs(), 0u);
}

TEST_F(WatchStateTest, LateStartOpensWhatHoldsAndGoesOn) {
  Model server(1);
  server.began({1, 2});
  server.began({3, 4});
  server.ended({1, 2});
  hear(server.bookmark());
  EXPECT_FALSE(state_.in_step()) << "the bookmark speaks of a contact that no shard has told yet";
  hear(server.shard({3, 4}));
  EXPECT_EQ(told(), Lines{"open 3 4 resync"});
  hear(server.ended({3, 4}));
  EXPECT_EQ(told(), Lines{"ended 3 4"});
  EXPECT_EQ(state_.resyncs(), 0u);
}

// A shard older than the bookmark is brought forward by the events heard since.
TEST_F(WatchStateTest, StartUsesOldShardsPlusEvents) {
  Model server(1);
  server.began({1, 2});
  hear(server.shard({1, 2}));
  hear(server.began({5, 6}));
  hear(server.ended({1, 2}));
  EXPECT_EQ(told(), Lines{}) << "nothing may come before what holds at the start";
  hear(server.bookmark());
  EXPECT_EQ(told(), Lines{"open 5 6 resync"});
}

TEST_F(WatchStateTest, EventsBehindTheFirstBookmarkFollowIt) {
  Model server(1);
  server.began({1, 2});
  const HeardBookmark bookmark = server.bookmark();
  const HeardShard shard = server.shard({1, 2});
  hear(server.began({3, 4}));
  hear(bookmark);
  hear(shard);
  EXPECT_EQ(told(), (Lines{"open 1 2 resync", "began 3 4"}));
}

TEST_F(WatchStateTest, RepeatedFramesAreToldOnce) {
  Model server(1);
  hear(server.bookmark());
  const HeardFrame frame = server.began({1, 2});
  hear(frame);
  hear(frame);
  EXPECT_EQ(told(), Lines{"began 1 2"});
  EXPECT_TRUE(state_.in_step());
}

TEST_F(WatchStateTest, LostBeganComesByResync) {
  Model server(1);
  hear(server.bookmark());
  server.began({1, 2});  // lost
  hear(server.began({3, 4}));
  EXPECT_FALSE(state_.in_step());
  EXPECT_EQ(told(), Lines{"began 3 4"}) << "a gap holds back nothing that did come";
  hear(server.bookmark());
  EXPECT_FALSE(state_.in_step());
  hear(server.shard({1, 2}));
  EXPECT_EQ(told(), Lines{"began 1 2 resync"});
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(state_.resyncs(), 1u);
}

TEST_F(WatchStateTest, LostEndedComesByResync) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  hear(server.shard({1, 2}));
  server.ended({1, 2});  // lost
  hear(server.began({3, 4}));
  hear(server.bookmark());
  EXPECT_FALSE(state_.in_step());
  hear(server.shard({1, 2}));
  EXPECT_EQ(told(), (Lines{"began 1 2", "began 3 4", "ended 1 2 resync"}));
}

// The end of an episode whose beginning was lost proves that there was one.
TEST_F(WatchStateTest, EndedAloneTellsTheMissedBegan) {
  Model server(1);
  hear(server.bookmark());
  server.began({1, 2});  // lost
  hear(server.ended({1, 2}));
  EXPECT_EQ(told(), (Lines{"began 1 2 resync", "ended 1 2"}));
}

TEST_F(WatchStateTest, NewEpisodeTellsTheMissedEnd) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  server.ended({1, 2});  // lost
  hear(server.began({1, 2}));
  EXPECT_EQ(told(), (Lines{"began 1 2", "ended 1 2 resync", "began 1 2"}));
}

// Nothing comes after the last event that could show the gap: only bookmarks tell.
TEST_F(WatchStateTest, LostTailIsNoticedAtTheSecondBookmark) {
  Model server(1);
  hear(server.bookmark());
  server.began({1, 2});  // lost
  hear(server.shard({1, 2}));
  hear(server.bookmark());
  EXPECT_EQ(told(), Lines{}) << "it may only be late";
  hear(server.bookmark());
  EXPECT_EQ(told(), Lines{"began 1 2 resync"});
  EXPECT_TRUE(state_.in_step());
  hear(server.ended({1, 2}));
  EXPECT_EQ(told(), Lines{"ended 1 2"});
}

TEST_F(WatchStateTest, LateTailIsNoGap) {
  Model server(1);
  hear(server.bookmark());
  const HeardFrame late = server.began({1, 2});
  hear(server.bookmark());
  hear(late);
  hear(server.bookmark());
  EXPECT_EQ(told(), Lines{"began 1 2"});
  EXPECT_EQ(state_.resyncs(), 0u);
}

// Each bookmark is ahead of what has come, and more comes each time: slow, and nothing is missing.
TEST_F(WatchStateTest, BookmarksAheadOfAStreamThatGoesOnAreNoGap) {
  Model server(1);
  hear(server.bookmark());
  const HeardFrame first = server.began({1, 2});
  const HeardFrame second = server.began({3, 4});
  hear(server.bookmark());
  hear(first);
  hear(server.bookmark());
  EXPECT_TRUE(state_.in_step());
  hear(second);
  hear(server.bookmark());
  EXPECT_EQ(told(), (Lines{"began 1 2", "began 3 4"}));
  EXPECT_EQ(state_.resyncs(), 0u);
}

// The count is right and the pair is wrong: only the hash can tell.
TEST_F(WatchStateTest, BookmarkThatDisagreesStartsAResync) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  Model other(1);
  other.began({3, 4});
  hear(other.bookmark());
  EXPECT_FALSE(state_.in_step());
  hear(other.shard({1, 2}));
  hear(other.shard({3, 4}));
  EXPECT_EQ(told(), (Lines{"began 1 2", "ended 1 2 resync", "began 3 4 resync"}));
  EXPECT_TRUE(state_.in_step());
}

// A watermark counts once the events that it counts on have come, and in the server's present life.
TEST_F(WatchStateTest, AWatermarkWaitsForItsEvents) {
  Model server(1);
  const auto settled_at = [&](auto heard, std::int64_t to_ns) {
    heard.settled_to = std::chrono::nanoseconds(to_ns);
    hear(heard);
    return state_.settled() ? state_.settled()->to.count() : 0;
  };
  const auto watermark = [&] {
    HeardFrame none = server.began({9, 9});
    none.entries.clear();
    server.ended({9, 9});
    return none;
  };
  EXPECT_EQ(settled_at(watermark(), 5), 0) << "nothing is known of what holds";
  hear(server.bookmark());
  EXPECT_FALSE(state_.settled()) << "the server's status had none";
  const HeardFrame first = server.began({1, 2});
  EXPECT_EQ(settled_at(server.bookmark(), 20), 0) << "of an event that has yet to come";
  EXPECT_EQ(settled_at(first, 10), 10);
  EXPECT_EQ(settled_at(server.bookmark(), 20), 20);
  HeardFrame next = server.ended({1, 2});
  next.entries.clear();
  EXPECT_EQ(settled_at(next, 30), 30) << "a frame without events counts on those before it";
  EXPECT_EQ(settled_at(next, 0), 30) << "a frame without a watermark";
  const Clock::time_point came = state_.settled()->came;
  EXPECT_EQ(settled_at(next, 25), 30) << "it does not go back";
  EXPECT_GT(state_.settled()->came, came);
  Model heir(2, 2);
  HeardBookmark bookmark = heir.bookmark();
  bookmark.heir_of = 1;
  bookmark.told_from = 4;
  for (std::uint8_t shard = 0; shard < 64; ++shard) hear(heir.shard(shard));
  EXPECT_EQ(settled_at(bookmark, 15), 15);
  EXPECT_EQ(state_.settled()->life, (ServerLife{2, 2}));
  EXPECT_EQ(state_.settled()->heir_of, 1U);
  EXPECT_EQ(state_.settled()->told_from, 4U);
}

}  // namespace
}  // namespace collided
