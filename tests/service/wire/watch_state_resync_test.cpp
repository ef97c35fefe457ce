// What a watch reports of contacts that changed while it missed the events.
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

TEST_F(WatchStateTest, AContactThatEndedAndBeganAnewInsideAGapIsTwo) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  server.ended({1, 2});  // lost
  server.began({1, 2});  // lost
  hear(server.began({3, 4}));
  hear(server.shard({1, 2}));
  hear(server.bookmark());
  EXPECT_EQ(told(), (Lines{"began 1 2", "began 3 4", "ended 1 2 resync", "began 1 2 resync"}));
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(events_.back().episode, 3u);
  state_.hear_persisted(server.persisted({1, 2}));
  hear(server.ended({1, 2}));
  EXPECT_EQ(told(), (Lines{"persisted 1 2", "ended 1 2"}));
  EXPECT_EQ(state_.resyncs(), 1u) << "nothing was missed after the gap";
}

TEST_F(WatchStateTest, AContactThatEndedAndBeganAnewAtALostTailIsTwo) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  server.ended({1, 2});  // lost
  server.began({1, 2});  // lost, and nothing comes after it
  hear(server.shard({1, 2}));
  hear(server.bookmark());
  hear(server.bookmark());
  EXPECT_EQ(told(), (Lines{"began 1 2", "ended 1 2 resync", "began 1 2 resync"}));
  hear(server.ended({1, 2}));
  EXPECT_EQ(told(), Lines{"ended 1 2"});
  EXPECT_EQ(state_.resyncs(), 1u);
}

TEST_F(WatchStateTest, TheEndOfALaterContactTellsThatOneWasMissed) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  server.ended({1, 2});  // lost
  server.began({1, 2});  // lost
  hear(server.ended({1, 2}));
  EXPECT_EQ(told(), (Lines{"began 1 2", "ended 1 2 resync", "began 1 2 resync", "ended 1 2"}));
}

TEST_F(WatchStateTest, ABookmarkOfAnotherCountStartsAResync) {
  Model server(1);
  hear(server.bookmark());
  hear(server.began({1, 2}));
  HeardBookmark wrong = server.bookmark();
  ++wrong.contact_count;
  hear(wrong);
  EXPECT_FALSE(state_.in_step());
  hear(server.shard({1, 2}));
  hear(wrong);
  EXPECT_FALSE(state_.in_step()) << "nothing heard has so many";
  hear(server.bookmark());
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(told(), Lines{"began 1 2"});
}

TEST_F(WatchStateTest, FramesThatOverlapTellEachEventOnce) {
  Model server(1);
  hear(server.bookmark());
  HeardFrame first = server.began({1, 2});
  const HeardFrame second = server.began({3, 4});
  HeardFrame both = first;
  both.entries.push_back(second.entries.front());
  HeardFrame last_two = both;
  last_two.entries.erase(last_two.entries.begin());
  last_two.first_sequence = 2;
  last_two.entries.push_back(server.ended({1, 2}).entries.front());
  hear(both);
  hear(last_two);
  hear(first);
  EXPECT_EQ(told(), (Lines{"began 1 2", "began 3 4", "ended 1 2"}));
  EXPECT_EQ(state_.resyncs(), 0u);
}

TEST_F(WatchStateTest, ContactsOfObjectsThatWereDefinedAnewEndUnderTheOldIds) {
  for (const bool swaps : {false, true}) {
    state_ = WatchState([this](const Event& event) { emit(event); });
    open_.clear();
    last_epoch_ = last_sequence_ = 0;
    Model server(1);
    hear(server.bookmark());
    hear(server.began({1, 2}));
    told();
    events_.clear();
    server.ended({1, 2});  // lost, as is that they went
    hear(redefined(server.began({1, 2}), 71, 72, swaps));
    ASSERT_EQ(events_.size(), 2u);
    EXPECT_EQ(events_[0].kind, EventKind::ended);
    EXPECT_EQ(events_[0].a_id, 1001u);
    EXPECT_EQ(events_[0].a, "1");
    EXPECT_EQ(events_[0].sequence, 3u);
    EXPECT_EQ(events_[1].kind, EventKind::began);
    EXPECT_EQ(events_[1].a_id, 71u);
    EXPECT_EQ(events_[1].a, swaps ? "2" : "1");
    open_.clear();
  }
}

TEST_F(WatchStateTest, AnEventIsToldWithItsOwnNumbersAndTheTimeAtWhichItBegan) {
  Model server(9);
  hear(server.bookmark());
  const HeardFrame began = with_numbers(server.began({1, 2}), 100);
  HeardFrame persisted = with_numbers(server.persisted({1, 2}), 200);
  const HeardFrame ended = with_numbers(server.ended({1, 2}, EndReason::removed), 300);
  hear(began);
  state_.hear_persisted(persisted);
  hear(ended);
  ASSERT_EQ(events_.size(), 3u);
  expect_numbers(events_[0], began.entries[0].event);
  expect_numbers(events_[1], persisted.entries[0].event);
  expect_numbers(events_[2], ended.entries[0].event);
  const int times_s[] = {102, 202, 302};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(events_[i].world_time, std::chrono::seconds(times_s[i]));
    EXPECT_EQ(events_[i].began, kFirstTouch) << "where its own bracket ends";
    EXPECT_EQ(events_[i].epoch, 9u);
    EXPECT_EQ(events_[i].episode, 1u);
    EXPECT_FALSE(events_[i].resync);
  }
  EXPECT_EQ(events_[0].sequence, 1u);
  EXPECT_EQ(events_[1].sequence, 1u) << "it has none of its own";
  EXPECT_EQ(events_[2].sequence, 2u);
  EXPECT_EQ(events_[0].reason, EndReason::none);
  EXPECT_EQ(events_[2].reason, EndReason::removed);
  EXPECT_EQ(lasted(events_[2]), std::chrono::nanoseconds(302'000'000'000 - 2'343'750'000) - kFirstTouch);
}

TEST_F(WatchStateTest, ADoubtBeginsWithTheFirstInstantThatIsNotDecided) {
  Model server(9);
  hear(server.bookmark());
  HeardFrame began = with_numbers(server.began({1, 2}), 100);
  began.entries.front().event.doubt = Doubt::numeric;
  hear(began);
  ASSERT_EQ(events_.size(), 1u);
  EXPECT_EQ(events_[0].began, std::chrono::nanoseconds(102'000'000'000 - 1'562'500'000));
}

// What was missed is told as it was told last, or as the shard has it, with the time and the number of the bookmark.
TEST_F(WatchStateTest, WhatWasMissedIsToldAsFarAsItIsKnown) {
  Model server(9);
  hear(server.bookmark());
  const HeardFrame began = with_numbers(server.began({1, 2}), 100);
  hear(began);
  server.ended({1, 2});  // lost
  server.began({5, 6});  // lost
  hear(server.began({3, 4}));
  HeardShard shard = server.shard({5, 6});
  for (Event& contact : shard.contacts) {
    if (contact.a == "5") contact = with_numbers(contact, 400);
  }
  if (server.shard_of({1, 2}) != shard.shard) hear(server.shard({1, 2}));
  hear(shard);
  HeardBookmark bookmark = server.bookmark();
  bookmark.world_time = std::chrono::seconds(777);
  hear(bookmark);
  ASSERT_EQ(events_.size(), 4u);
  const Event& ended = events_[2];
  EXPECT_EQ(ended.kind, EventKind::ended);
  expect_numbers(ended, began.entries[0].event);
  EXPECT_EQ(ended.world_time, std::chrono::seconds(777));
  EXPECT_EQ(ended.began, kFirstTouch);
  EXPECT_EQ(ended.sequence, 4u);
  EXPECT_EQ(ended.episode, 1u);
  EXPECT_EQ(ended.epoch, 9u);
  EXPECT_TRUE(ended.resync);
  const Event& found = events_[3];
  EXPECT_EQ(found.kind, EventKind::began);
  EXPECT_EQ(found.point, Vec3(405, 406, 407));
  EXPECT_EQ(found.normal, Vec3(408, 409, 410));
  EXPECT_EQ(found.world_time, std::chrono::seconds(402));
  EXPECT_EQ(found.began, std::chrono::seconds(402));
  EXPECT_EQ(found.sequence, 4u);
  EXPECT_EQ(found.episode, 3u);
  EXPECT_TRUE(found.resync);
}

// A contact that goes on over a restart began when it began: ids and episode are the new server's, and the names may have
// changed places with them.

}  // namespace
}  // namespace collided
