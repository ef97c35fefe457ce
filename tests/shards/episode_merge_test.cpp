#include "client/fleet/shards/episode_merge.hpp"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <limits>
#include <ostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/studies/bench/clock.hpp"

namespace collided::client {
namespace {

using std::chrono::nanoseconds;

constexpr const char* kStrips = R"({"margin_m": 1, "shards": [
  {"name": "a", "low": [null, null, null], "high": [0, null, null]},
  {"name": "b", "low": [0, null, null], "high": [10, null, null]},
  {"name": "c", "low": [10, null, null], "high": [null, null, null]}]})";

Event event_of(EventKind kind, std::int64_t at_ns, double x, EndReason reason = EndReason::none) {
  Event event{.kind = kind, .reason = reason, .a = "fork", .b = "wall", .world_time = nanoseconds(at_ns)};
  event.point = {x, 0, 0};
  return event;
}

struct ToldByMerge {
  EventKind kind;
  std::int64_t at_ns;
  EndReason reason;
  bool operator==(const ToldByMerge&) const = default;
};
void PrintTo(const ToldByMerge& told, std::ostream* out) {
  *out << "kind " << static_cast<int>(told.kind) << " at " << told.at_ns << " reason " << static_cast<int>(told.reason);
}

/// A draw from this to that.
using Between = std::function<std::int64_t(std::int64_t, std::int64_t)>;

class MergedEpisodes : public ::testing::Test {
 protected:
  std::vector<ToldByMerge> settle(std::int64_t through_ns) {
    told_.clear();
    merge_.settle(nanoseconds(through_ns));
    return told_;
  }

  /// What a merge of its own tells of these streams, one for each shard, mixed at random. A shard is heard up to a time before
  /// the merge may settle it.
  ///
  /// forgotten_ns  when the watch lets shard 0 go
  void merge_at_random(const std::vector<std::vector<Event>>& streams, const Between& between,
                       std::int64_t forgotten_ns = std::numeric_limits<std::int64_t>::max()) {
    told_.clear();
    EpisodeMerge merge(map_, [this](const Event& event) {
      told_.push_back({event.kind, happened(event).count(), event.reason});
    });
    std::vector<std::size_t> heard(streams.size());
    bool is_there = true;
    for (std::int64_t through = 0; through <= 40'000; through += between(100, 3'000)) {
      if (is_there && through > forgotten_ns) {
        merge.forget(0);
        is_there = false;
      }
      for (std::size_t shard = is_there ? 0 : 1; shard < streams.size(); ++shard) {
        while (heard[shard] < streams[shard].size() &&
               (happened(streams[shard][heard[shard]]).count() <= through + 1'000 || between(0, 3) == 0)) {
          merge.hear(shard, streams[shard][heard[shard]++]);
        }
      }
      merge.settle(nanoseconds(through));
    }
    merge.settle(nanoseconds(100'000));
  }

  const shards::ShardMap map_ = shards::ShardMap::parse(kStrips);
  std::vector<ToldByMerge> told_;
  std::vector<Event> events_;
  EpisodeMerge merge_{map_, [this](const Event& event) {
                        told_.push_back({event.kind, happened(event).count(), event.reason});
                        events_.push_back(event);
                      }};
};

TEST_F(MergedEpisodes, WhatTwoShardsTellIsToldOnceByTheOneWithThePoint) {
  Event other = event_of(EventKind::began, 1'001, 3);
  std::swap(other.a, other.b);  // numbers, and so the order, differ from shard to shard
  other.normal = {-1, 0, 0};
  Event own = event_of(EventKind::began, 1'000, 3);
  own.normal = {1, 0, 0};
  own.depth_m = 0.5;
  merge_.hear(0, other);
  merge_.hear(1, own);
  EXPECT_TRUE(settle(999).empty());
  EXPECT_EQ(settle(2'000), (std::vector<ToldByMerge>{{EventKind::began, 1'000, EndReason::none}}));
  EXPECT_EQ(events_.front().depth_m, 0.5);
  EXPECT_EQ(events_.front().a, "fork");
  EXPECT_EQ(merge_.open_contacts(), 1u);
  merge_.hear(1, event_of(EventKind::ended, 3'000, 4, EndReason::separated));
  merge_.hear(0, event_of(EventKind::ended, 3'001, 4, EndReason::separated));
  EXPECT_EQ(settle(4'000), (std::vector<ToldByMerge>{{EventKind::ended, 3'000, EndReason::separated}}));
  EXPECT_EQ(events_.back().episode, events_.front().sequence);
  EXPECT_EQ(merge_.open_contacts(), 0u);
}

TEST_F(MergedEpisodes, OneThatGoesFromShardToShardStaysOpen) {
  merge_.hear(0, event_of(EventKind::began, 1'000, -3));
  merge_.hear(1, event_of(EventKind::began, 5'000, -1));  // it enters while the two touch
  merge_.hear(0, event_of(EventKind::ended, 9'000, -1, EndReason::removed));
  merge_.hear(2, event_of(EventKind::began, 9'500, 9));
  merge_.hear(1, event_of(EventKind::ended, 12'000, 11, EndReason::removed));
  merge_.hear(2, event_of(EventKind::ended, 15'000, 20, EndReason::separated));
  EXPECT_EQ(settle(20'000), (std::vector<ToldByMerge>{{EventKind::began, 1'000, EndReason::none},
                                                      {EventKind::ended, 15'000, EndReason::separated}}));
}

TEST_F(MergedEpisodes, ARemovalByTheServersClockDoesNotUndoWhatComesBack) {
  merge_.hear(0, event_of(EventKind::began, 1'000, -3));
  merge_.hear(1, event_of(EventKind::began, 1'000, -3));
  merge_.hear(1, event_of(EventKind::ended, 9'000, -3, EndReason::removed));  // its server's clock is ahead
  merge_.hear(1, event_of(EventKind::began, 6'000, -1));
  merge_.hear(0, event_of(EventKind::ended, 7'000, 1, EndReason::removed));
  EXPECT_EQ(settle(20'000), (std::vector<ToldByMerge>{{EventKind::began, 1'000, EndReason::none}}));
}

TEST_F(MergedEpisodes, WhatIsRemovedEverywhereHasEnded) {
  for (const std::size_t shard : {0, 1}) merge_.hear(shard, event_of(EventKind::began, 1'000, 0));
  for (const std::size_t shard : {0, 1})
    merge_.hear(shard,
                event_of(EventKind::ended, 4'000 + static_cast<std::int64_t>(shard) * 100, 0, EndReason::removed));
  const std::vector<ToldByMerge> told = settle(20'000);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told.back().kind, EventKind::ended);
  EXPECT_EQ(told.back().reason, EndReason::removed);
}

// A contact is over in a shard for a reason that is the shard's own, while another shard holds it all the time.
TEST_F(MergedEpisodes, AreNotEndedByOneShardForAReasonOfItsOwn) {
  for (const std::size_t shard : {0, 1}) merge_.hear(shard, event_of(EventKind::began, 1'000, 0));
  EXPECT_EQ(settle(1'500).size(), 1u);
  std::int64_t at_ns = 2'000;
  for (const EndReason own : {EndReason::server_stopping, EndReason::server_restarted, EndReason::publisher_lost,
                              EndReason::teleported, EndReason::removed}) {
    merge_.hear(1, event_of(EventKind::ended, at_ns, 0, own));
    merge_.hear(1, event_of(EventKind::began, at_ns + 500, 0));
    EXPECT_TRUE(settle(at_ns + 900).empty()) << "reason " << static_cast<int>(own);
    at_ns += 1'000;
  }
  // The last shard that holds it reports its end.
  merge_.hear(1, event_of(EventKind::ended, 8'000, 0, EndReason::server_stopping));
  merge_.hear(0, event_of(EventKind::ended, 9'000, 0, EndReason::publisher_lost));
  EXPECT_EQ(settle(10'000), (std::vector<ToldByMerge>{{EventKind::ended, 9'000, EndReason::publisher_lost}}));
  EXPECT_EQ(merge_.open_contacts(), 0u);
}

TEST_F(MergedEpisodes, AreEndedByAnObjectThatJumpsInEveryShard) {
  for (const std::size_t shard : {0, 1}) {
    merge_.hear(shard, event_of(EventKind::began, 1'000, 0));
    merge_.hear(shard, event_of(EventKind::ended, 2'000, 0, EndReason::teleported));
    merge_.hear(shard, event_of(EventKind::began, 2'000, 0));
  }
  EXPECT_EQ(settle(20'000), (std::vector<ToldByMerge>{{EventKind::began, 1'000, EndReason::none},
                                                      {EventKind::ended, 2'000, EndReason::teleported},
                                                      {EventKind::began, 2'000, EndReason::none}}));
}

// An object of a lost publisher that stays (LostPolicy::freeze) puts the pair in doubt.
TEST_F(MergedEpisodes, TurnIntoADoubtWhenAPublisherIsLost) {
  for (const std::size_t shard : {0, 1}) merge_.hear(shard, event_of(EventKind::began, 1'000, 0));
  merge_.hear(0, event_of(EventKind::ended, 2'000, 0, EndReason::publisher_lost));
  Event doubt = event_of(EventKind::began, 2'000, 0);
  doubt.doubt = Doubt::publisher_lost;
  merge_.hear(0, doubt);
  settle(20'000);
  ASSERT_EQ(events_.size(), 3u);
  EXPECT_EQ(events_[1].reason, EndReason::publisher_lost);
  EXPECT_EQ(events_[2].doubt, Doubt::publisher_lost);
}

// What a shard said before it was forgotten holds nothing open, and what it has said of later is nothing.
TEST_F(MergedEpisodes, WhatIsForgottenHoldsNothing) {
  for (const std::size_t shard : {0, 1}) merge_.hear(shard, event_of(EventKind::began, 1'000, 0));
  EXPECT_EQ(settle(2'000).size(), 1u);
  merge_.hear(0, event_of(EventKind::ended, 3'000, 0, EndReason::server_stopping));
  merge_.forget(0);
  EXPECT_TRUE(settle(4'000).empty());
  EXPECT_EQ(merge_.open_contacts(), 1u);
  merge_.hear(1, event_of(EventKind::ended, 5'000, 0, EndReason::removed));
  EXPECT_EQ(settle(6'000), (std::vector<ToldByMerge>{{EventKind::ended, 5'000, EndReason::removed}}));
}

TEST_F(MergedEpisodes, ANewShapeEndsAndBeginsInEveryShard) {
  for (const std::size_t shard : {0, 1}) {
    merge_.hear(shard, event_of(EventKind::began, 1'000, 0));
    merge_.hear(shard, event_of(EventKind::ended, 2'000, 0, EndReason::geometry_changed));
    merge_.hear(shard, event_of(EventKind::began, 2'000, 0));
  }
  EXPECT_EQ(settle(20'000), (std::vector<ToldByMerge>{{EventKind::began, 1'000, EndReason::none},
                                                      {EventKind::ended, 2'000, EndReason::geometry_changed},
                                                      {EventKind::began, 2'000, EndReason::none}}));
}

// One who begins to watch a shard is told what is open there, with the instant in which it was found.
// While a shard is late with its answers, the events of a pair pile up. Processor time of this thread: other programs do not
// count.
TEST_F(MergedEpisodes, AreTakenInTimeProportionalToTheirNumber) {
  const auto spent_s = [&](int count) {
    const double before_s = bench::thread_seconds();
    for (int i = 0; i < count; ++i) merge_.hear(0, event_of(i % 2 == 0 ? EventKind::began : EventKind::ended, i, -1));
    settle(count);
    const double after_s = bench::thread_seconds();
    EXPECT_EQ(told_.size(), static_cast<std::size_t>(count));
    return after_s - before_s;
  };
  constexpr int kFew = 4'000;
  double few_s = spent_s(kFew);
  double many_s = spent_s(8 * kFew);
  for (int more = 0; more < 2; ++more) {
    few_s = std::min(few_s, spent_s(kFew));
    many_s = std::min(many_s, spent_s(8 * kFew));
  }
  EXPECT_LT(many_s, 3 * 8 * few_s) << "with a walk over all that waits it would be 64 times as long";
}

TEST_F(MergedEpisodes, WhatBeginsWhileAShardIsJoinedHasBegun) {
  Event open = event_of(EventKind::open, 1'000, 3);
  open.began = nanoseconds(1'000);
  merge_.hear(2, open);
  merge_.hear(1, event_of(EventKind::began, 1'001, 3));
  EXPECT_EQ(settle(2'000), (std::vector<ToldByMerge>{{EventKind::began, 1'001, EndReason::none}}));
}

/// Each round draws from a seed of its own; the first one that fails is the last.
void in_random_rounds(const std::function<void(const Between&)>& round) {
  const char* const given = std::getenv("COLLIDED_SEED");
  const std::uint64_t first = given != nullptr ? std::strtoull(given, nullptr, 10) : 28;
  for (std::uint64_t seed = first; seed < first + 3'000 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("COLLIDED_SEED=" + std::to_string(seed));
    std::mt19937_64 random(seed);
    round([&](std::int64_t low, std::int64_t high) {
      return std::uniform_int_distribution<std::int64_t>(low, high)(random);
    });
  }
}

/// A list of contacts, in turn.
std::vector<std::pair<std::int64_t, std::int64_t>> random_contacts(const Between& between) {
  std::vector<std::pair<std::int64_t, std::int64_t>> contacts;
  for (std::int64_t t = between(0, 500); t < 20'000;) {
    const std::int64_t end = t + between(50, 3'000);
    contacts.emplace_back(t, end);
    t = end + between(50, 3'000);
  }
  return contacts;
}

std::vector<ToldByMerge> truth_of(const std::vector<std::pair<std::int64_t, std::int64_t>>& contacts) {
  std::vector<ToldByMerge> truth;
  for (const auto& [begin, end] : contacts) {
    truth.push_back({EventKind::began, begin, EndReason::none});
    truth.push_back({EventKind::ended, end, EndReason::separated});
  }
  return truth;
}

/// What is told within two nanoseconds is one instant, of whichever shard.
void expect_truth(std::vector<ToldByMerge> told, const std::vector<ToldByMerge>& truth) {
  constexpr std::int64_t kRounded = 2;
  ASSERT_EQ(told.size(), truth.size());
  for (std::size_t i = 0; i < told.size(); ++i) {
    if (std::abs(told[i].at_ns - truth[i].at_ns) <= kRounded) told[i].at_ns = truth[i].at_ns;
  }
  ASSERT_EQ(told, truth);
}

/// A shard is split: two others come to hold the pair, each at an instant of its own, and tell what they find, as something
/// that begins, or that is open where the watch came later. The one that was split tells all, until it is over: then its
/// publishers leave it, by a clock of its own, and the watch forgets it sooner or later.
TEST_F(MergedEpisodes, AreTheTruthWhileAShardIsSplit) {
  in_random_rounds([&](const Between& between) {
    const auto contacts = random_contacts(between);
    const std::int64_t over = between(9'000, 15'000);
    std::vector<std::vector<Event>> streams(3);
    for (std::size_t shard = 0; shard < 3; ++shard) {
      const std::int64_t from = shard == 0 ? -1'000 : between(500, 6'000);
      for (const auto& [begin, end] : contacts) {
        if (end <= from || (shard == 0 && begin >= over)) continue;
        const bool is_found = begin < from;
        Event began =
            event_of(is_found && between(0, 1) == 0 ? EventKind::open : EventKind::began, std::max(begin, from), 0);
        began.began = began.kind == EventKind::open ? began.world_time : nanoseconds(0);
        streams[shard].push_back(began);
        const bool is_cut = shard == 0 && end > over;
        streams[shard].push_back(is_cut ? event_of(EventKind::ended, over + between(0, 400), 0, EndReason::removed)
                                        : event_of(EventKind::ended, end + between(0, 2), 0, EndReason::separated));
      }
    }
    merge_at_random(streams, between, over + between(0, 3'000));
    expect_truth(told_, truth_of(contacts));
  });
}

/// The truth is a list of contacts. Each shard holds the pair for some stretches, together at all times, and tells what it
/// sees: what it finds when it is given the pair, and a removal when it is taken away, by a clock of its own. In order for
/// each shard, mixed at random between them. The merged stream must be the truth.
TEST_F(MergedEpisodes, AreTheTruthWhateverTheShardsHold) {
  in_random_rounds([&](const Between& between) {
    const auto contacts = random_contacts(between);
    // Who holds the pair: the next one begins well before the last one has forgotten it, and nobody holds it twice at a time.
    std::vector<std::vector<Event>> streams(3);
    std::size_t holder = static_cast<std::size_t>(between(0, 2));
    for (std::int64_t from = -1'000; from < 30'000;) {
      const std::int64_t to = from + between(3'500, 6'000);
      const std::int64_t clock_ahead = between(0, 400);
      for (const auto& [begin, end] : contacts) {
        if (end <= from || begin >= to) continue;
        streams[holder].push_back(event_of(EventKind::began, std::max(begin, from), 0));
        const bool is_cut = end > to;
        streams[holder].push_back(is_cut ? event_of(EventKind::ended, to + clock_ahead, 0, EndReason::removed)
                                         : event_of(EventKind::ended, end, 0, EndReason::separated));
      }
      from = to - between(500, 1'500);
      holder = (holder + static_cast<std::size_t>(between(1, 2))) % 3;
    }
    merge_at_random(streams, between);
    expect_truth(told_, truth_of(contacts));
  });
}

}  // namespace
}  // namespace collided::client
