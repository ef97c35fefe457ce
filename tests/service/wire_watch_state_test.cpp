#include "client/library/watch_state.hpp"

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
  std::vector<std::string> told() { return std::exchange(told_, {}); }
  void emit(const Event& event) {
    const Pair pair{std::stoull(event.a), std::stoull(event.b)};
    if (event.what == What::ended) {
      EXPECT_EQ(open_.erase(pair), 1u) << event.a << ' ' << event.b << " ended without having begun";
    } else if (event.what != What::persisted) {
      EXPECT_TRUE(open_.insert(pair).second) << event.a << ' ' << event.b << " began twice";
    } else {
      EXPECT_TRUE(open_.contains(pair)) << event.a << ' ' << event.b << " persisted without having begun";
    }
    EXPECT_GE(event.sequence, event.epoch == last_epoch_ ? last_sequence_ : 0) << "out of order";
    last_epoch_ = event.epoch;
    last_sequence_ = event.sequence;
    told_.push_back(std::string(kWhat[static_cast<int>(event.what)]) + ' ' + event.a + ' ' + event.b +
                    (event.resync ? " resync" : "") + (event.why == Why::server_restarted ? " restarted" : ""));
  }
  std::set<Pair> open_;
  Clock::time_point now_{milliseconds(1'000)};
  std::vector<std::string> told_;
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

/// A server that begins and ends at random, with a lossy, repeating, delaying line between.
class Simulation {
 public:
  explicit Simulation(std::uint64_t seed) : random_(seed) {}
  bool chance(double probability) { return std::uniform_real_distribution<>(0, 1)(random_) < probability; }
  std::uint64_t below(std::uint64_t limit) { return std::uniform_int_distribution<std::uint64_t>(0, limit - 1)(random_); }

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
      if (line.chance(0.005)) {
        server = Model(++epoch);
      }
      const HeardFrame frame = line.step(server);
      if (line.chance(0.9)) {
        hear(frame);
      }
      if (!server.contacts().empty() && line.chance(0.2)) {
        state_.hear_persisted(server.persisted(server.contacts().begin()->first));
      }
      if (delayed && line.chance(0.5)) {
        hear(*std::exchange(delayed, std::nullopt));
      }
      if (line.chance(0.05)) {
        delayed = frame;
      }
      if (line.chance(0.3)) {
        hear(server.shard(line.any_pair()));
      }
      if (line.chance(0.1)) {
        hear(server.bookmark(line.chance(0.9)));
      }
    }
    for (int shard = 0; shard < static_cast<int>(wire_contract::kContactShards); ++shard) {
      hear(server.shard(static_cast<std::uint8_t>(shard)));
    }
    hear(server.bookmark());
    hear(server.bookmark());
    std::set<Pair> truth;
    for (const auto& [pair, episode] : server.contacts()) {
      truth.insert(pair);
    }
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
    ASSERT_EQ(told(), Lines{std::string(kWhat[static_cast<int>(event.what)]) + ' ' + event.a + ' ' + event.b});
    if (line.chance(0.05)) {
      hear(server.shard(line.any_pair()));
      hear(server.bookmark());
    }
  }
  EXPECT_EQ(state_.resyncs(), 0u);
}

}  // namespace
}  // namespace collided
