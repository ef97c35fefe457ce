#include "client/library/watching/watch_state.hpp"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "tests/service/watch_model.hpp"

namespace collided {
namespace {

using client::Clock;
using client::HeardBookmark;
using client::HeardFrame;
using client::HeardShard;
using client::ServerLife;
using client::WatchState;
using std::chrono::milliseconds;
using test::Model;
using test::Pair;

constexpr const char* kWhat[] = {"open", "began", "persisted", "ended"};

/// A watch that remembers what it was told, and checks that began and ended alternate.
class WatchStateTest : public testing::Test {
 protected:
  template <class Heard>
  void hear(const Heard& heard) {
    now_ += milliseconds(1);
    state_.hear(heard, now_);
  }
  void pass(milliseconds time) { now_ += time; }
  /// "began 1 2", "ended 1 2 resync restarted", ... since the last call.
  std::vector<std::string> told() { return std::exchange(reported_, {}); }
  void emit(const Event& event) {
    // Which name comes first hangs on the ids, and those change when an object is defined anew.
    const Pair pair = std::minmax(std::stoull(event.a), std::stoull(event.b));
    if (event.kind == EventKind::ended) {
      EXPECT_EQ(open_.erase(pair), 1u) << event.a << ' ' << event.b << " ended without having begun";
    } else if (event.kind != EventKind::persisted) {
      EXPECT_TRUE(open_.insert(pair).second) << event.a << ' ' << event.b << " began twice";
    } else {
      EXPECT_TRUE(open_.contains(pair)) << event.a << ' ' << event.b << " persisted without having begun";
    }
    EXPECT_GE(event.sequence, event.epoch == last_epoch_ ? last_sequence_ : 0) << "out of order";
    last_epoch_ = event.epoch;
    last_sequence_ = event.sequence;
    events_.push_back(event);
    reported_.push_back(std::string(kWhat[static_cast<int>(event.kind)]) + ' ' + event.a + ' ' + event.b +
                        (event.resync ? " resync" : "") +
                        (event.reason == EndReason::server_restarted ? " restarted" : ""));
  }
  std::set<Pair> open_;
  Clock::time_point now_{milliseconds(1'000)};
  std::vector<std::string> reported_;
  std::vector<Event> events_;  // all that were told
  std::uint64_t last_epoch_ = 0;
  std::uint64_t last_sequence_ = 0;
  WatchState state_{[this](const Event& event) { emit(event); }};
};

using Lines = std::vector<std::string>;

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
  Model second(5, 2);
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

/// The objects of a pair were defined anew: other ids, the same names, and which id is the lower may have changed.
HeardFrame redefined(HeardFrame frame, std::uint64_t a_id, std::uint64_t b_id, bool swaps_names) {
  Event& event = frame.entries.front().event;
  event.a_id = a_id;
  event.b_id = b_id;
  if (swaps_names) std::swap(event.a, event.b);
  return frame;
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

/// Numbers of its own in every field that a contact has.
Event with_numbers(Event event, double from) {
  event.a_triangle = static_cast<std::uint32_t>(from);
  event.b_triangle = static_cast<std::uint32_t>(from) + 1;
  event.world_time = std::chrono::seconds(static_cast<int>(from) + 2);
  event.began = event.kind == EventKind::open ? event.world_time : std::chrono::nanoseconds(0);
  event.bracket_low_s = from / 64;
  event.bracket_high_s = from / 128;
  event.point = {from + 5, from + 6, from + 7};
  event.normal = {from + 8, from + 9, from + 10};
  event.depth_m = from + 11;
  event.depth_error_m = from + 12;
  event.relative_velocity = {from + 13, from + 14, from + 15};
  return event;
}
constexpr std::chrono::nanoseconds kFirstTouch{102'000'000'000 - 781'250'000};  // of with_numbers(began, 100)
HeardFrame with_numbers(HeardFrame frame, double from) {
  frame.entries.front().event = with_numbers(frame.entries.front().event, from);
  return frame;
}

void expect_numbers(const Event& event, const Event& expected) {
  EXPECT_EQ(event.a_triangle, expected.a_triangle);
  EXPECT_EQ(event.b_triangle, expected.b_triangle);
  EXPECT_EQ(event.bracket_low_s, expected.bracket_low_s);
  EXPECT_EQ(event.bracket_high_s, expected.bracket_high_s);
  EXPECT_EQ(event.point, expected.point);
  EXPECT_EQ(event.normal, expected.normal);
  EXPECT_EQ(event.depth_m, expected.depth_m);
  EXPECT_EQ(event.depth_error_m, expected.depth_error_m);
  EXPECT_EQ(event.relative_velocity, expected.relative_velocity);
  EXPECT_EQ(event.a_id, expected.a_id);
  EXPECT_EQ(event.b_id, expected.b_id);
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
class Simulation {
 public:
  explicit Simulation(std::uint64_t seed) : random_(seed) {}
  bool chance(double probability) { return std::uniform_real_distribution<>(0, 1)(random_) < probability; }
  std::uint64_t below(std::uint64_t limit) {
    return std::uniform_int_distribution<std::uint64_t>(0, limit - 1)(random_);
  }

  Pair any_pair() {
    const std::uint64_t a = below(6);
    return {a, a + 1 + below(5)};
  }
  HeardFrame step(Model& server) {
    const Pair pair = any_pair();
    return server.contacts().contains(pair) ? server.ended(pair) : server.began(pair);
  }

 private:
  std::mt19937_64 random_;
};

std::uint64_t seed() {
  const char* const given = std::getenv("COLLIDED_SEED");
  return given != nullptr ? std::stoull(given) : std::random_device{}();
}

// Whatever is lost, repeated or delayed: told events alternate (checked in emit), and when the line is good again what
// was told is what holds.
TEST_F(WatchStateTest, LossyLineEndsInTheTruth) {
  const std::uint64_t first_seed = seed();
  SCOPED_TRACE("COLLIDED_SEED=" + std::to_string(first_seed));
  for (std::uint64_t run = 0; run < 300 && !HasFailure(); ++run) {
    SCOPED_TRACE("run " + std::to_string(run));
    Simulation line(first_seed + run);
    open_.clear();
    last_epoch_ = last_sequence_ = 0;
    state_ = WatchState([this](const Event& event) { emit(event); });
    Model server(1);
    std::uint64_t epoch = 1;
    std::optional<HeardFrame> delayed;
    for (int i = 0; i < 400; ++i) {
      if (line.chance(0.005)) { server = Model(++epoch); }
      const HeardFrame frame = line.step(server);
      if (line.chance(0.9)) { hear(frame); }
      if (!server.contacts().empty() && line.chance(0.2)) {
        state_.hear_persisted(server.persisted(server.contacts().begin()->first));
      }
      if (delayed && line.chance(0.5)) { hear(*std::exchange(delayed, std::nullopt)); }
      if (line.chance(0.05)) { delayed = frame; }
      if (line.chance(0.3)) { hear(server.shard(line.any_pair())); }
      if (line.chance(0.1)) { hear(server.bookmark(line.chance(0.9))); }
    }
    for (int shard = 0; shard < static_cast<int>(wire_contract::kContactShards); ++shard) {
      hear(server.shard(static_cast<std::uint8_t>(shard)));
    }
    hear(server.bookmark());
    hear(server.bookmark());
    std::set<Pair> truth;
    for (const auto& [pair, episode] : server.contacts()) { truth.insert(pair); }
    EXPECT_EQ(open_, truth);
    EXPECT_TRUE(state_.in_step());
  }
}

TEST_F(WatchStateTest, GoodLineTellsEveryEventOnceAndNeverResyncs) {
  const std::uint64_t first_seed = seed();
  SCOPED_TRACE("COLLIDED_SEED=" + std::to_string(first_seed));
  Simulation line(first_seed);
  Model server(1);
  hear(server.bookmark());
  for (int i = 0; i < 5'000; ++i) {
    const HeardFrame frame = line.step(server);
    hear(frame);
    const Event& event = frame.entries[0].event;
    ASSERT_EQ(told(), Lines{std::string(kWhat[static_cast<int>(event.kind)]) + ' ' + event.a + ' ' + event.b});
    if (line.chance(0.05)) {
      hear(server.shard(line.any_pair()));
      hear(server.bookmark());
    }
  }
  EXPECT_EQ(state_.resyncs(), 0u);
}

}  // namespace
}  // namespace collided
