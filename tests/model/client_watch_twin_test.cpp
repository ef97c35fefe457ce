#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "client/library/watching/watch_state.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/wire/watch_model.hpp"
#include "tests/model/rounds_asked.hpp"

// One WatchState against peers that repeat, reorder, lose, restart and talk across each other, beside a plain log of all that
// the current life of the current server ever said.
namespace collided {
namespace {

using client::HeardBookmark;
using client::HeardFrame;
using client::HeardShard;
using client::WatchState;
using test::Model;
using test::Pair;

bool are_equal(const Event& told, const Event& said) {
  return told.kind == said.kind && told.reason == said.reason && told.a == said.a && told.b == said.b &&
         told.a_id == said.a_id && told.b_id == said.b_id && told.a_triangle == said.a_triangle &&
         told.b_triangle == said.b_triangle && told.episode == said.episode && told.world_time == said.world_time &&
         told.bracket_low_s == said.bracket_low_s && told.bracket_high_s == said.bracket_high_s &&
         told.point == said.point && told.normal == said.normal && told.depth_m == said.depth_m &&
         told.depth_error_m == said.depth_error_m && told.relative_velocity == said.relative_velocity;
}

class WatchTwin : public testing::Test {
 protected:
  double uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  bool chance(double probability) { return uniform() < probability; }
  std::uint64_t below(std::uint64_t count) {
    return std::uniform_int_distribution<std::uint64_t>(0, count - 1)(random_);
  }
  Pair any_pair() {
    const std::uint64_t a = below(6);
    return {a, a + 1 + below(5)};
  }

  // ---- what the server says; each event with numbers of its own
  HeardFrame decorated(HeardFrame frame) {
    for (auto& entry : frame.entries) {
      Event& event = entry.event;
      event.world_time = std::chrono::nanoseconds(++clock_);
      event.a_triangle = static_cast<std::uint32_t>(below(9));
      event.b_triangle = static_cast<std::uint32_t>(below(9));
      for (double* number : {&event.bracket_low_s, &event.bracket_high_s, &event.depth_m, &event.depth_error_m})
        *number = uniform();
      for (int i = 0; i < 3; ++i)
        event.point[i] = uniform(), event.normal[i] = uniform(), event.relative_velocity[i] = uniform();
    }
    return frame;
  }
  /// One to three events in a frame.
  HeardFrame say() {
    HeardFrame frame;
    for (std::uint64_t left = 1 + below(3); left > 0; --left) {
      const Pair pair = any_pair();
      const bool holds = server_.contacts().contains(pair);
      HeardFrame one = decorated(holds ? server_.ended(pair, chance(0.5) ? EndReason::separated : EndReason::removed)
                                       : server_.began(pair));
      log_[one.first_sequence] = one.entries[0].event;
      if (frame.entries.empty()) frame = one;
      else frame.entries.push_back(one.entries[0]);
    }
    said_.push_back(frame);
    return frame;
  }
  void restart() {
    server_ = Model(++epoch_);
    log_.clear();
    old_said_.insert(old_said_.end(), said_.begin(), said_.end());
    said_.clear();
    shards_.clear();
    heard_through_ = 0;
  }

  // ---- what is told
  void emit(const Event& event) {
    ++told_count_;
    const std::pair<std::string, std::string> names = std::minmax(event.a, event.b);
    EXPECT_EQ(event.epoch, epoch_) << "of a life that is over";
    if (event.kind == EventKind::persisted) {
      EXPECT_TRUE(open_.contains(names)) << "goes on, but was not told";
      // What was told in an earlier life of the server has another number in this one.
      EXPECT_TRUE(open_[names].epoch != event.epoch || open_[names].episode == event.episode)
          << "of an earlier episode";
      return;
    }
    // Of a solid's contents these are told besides; the model has none.
    EXPECT_LE(event.kind, EventKind::ended);
    if (event.kind == EventKind::ended)
      EXPECT_EQ(open_.erase(names), 1u) << event.a << " " << event.b << " ended without having begun";
    else
      EXPECT_TRUE(open_.emplace(names, Told{event.epoch, event.episode}).second)
          << event.a << " " << event.b << " began twice";
    if (event.resync) return;
    ASSERT_TRUE(log_.contains(event.sequence));
    EXPECT_TRUE(are_equal(event, log_[event.sequence])) << "event " << event.sequence << " is told as it was said";
    EXPECT_GT(event.sequence, event.epoch == last_epoch_ ? last_told_ : 0) << "told twice, or out of turn";
    last_epoch_ = event.epoch;
    last_told_ = event.sequence;
  }

  template <class Heard>
  void hear(const Heard& heard) {
    now_ += std::chrono::milliseconds(1);
    state_.hear(heard, now_);
  }
  /// In step, what is new and next is told at once, one by one; what is old says nothing; a gap is seen at once.
  void deliver(const HeardFrame& frame) {
    const bool was_in_step = state_.in_step() && heard_any_;
    const std::uint64_t resyncs = state_.resyncs(), last = frame.first_sequence + frame.entries.size() - 1;
    const std::uint64_t known = std::max(heard_through_, frame.first_sequence - 1);
    const bool is_next = frame.first_sequence <= heard_through_ + 1;
    const std::size_t news = last > known ? last - known : 0;
    told_count_ = 0;
    hear(frame);
    if (!was_in_step) {
      heard_through_ = std::max(heard_through_, last);
      return;
    }
    if (is_next) {
      EXPECT_EQ(told_count_, news) << "from " << frame.first_sequence << " to " << last << " after " << heard_through_;
      EXPECT_EQ(state_.resyncs(), resyncs);
    } else {
      EXPECT_FALSE(state_.in_step()) << "a gap";
      EXPECT_EQ(state_.resyncs(), resyncs + 1);
    }
    heard_through_ = std::max(heard_through_, last);
  }
  /// Whatever another server or an earlier life says is nothing.
  template <class Heard>
  void deliver_foreign(Heard heard, bool other_server) {
    if (other_server) heard.from = {2, 0};
    const bool was_in_step = state_.in_step();
    const std::uint64_t resyncs = state_.resyncs();
    told_count_ = 0;
    hear(heard);
    EXPECT_EQ(told_count_, 0u) << "of another server, or of a life that is over";
    EXPECT_EQ(state_.in_step(), was_in_step);
    EXPECT_EQ(state_.resyncs(), resyncs);
  }
  HeardShard keep_shard() {
    shards_.push_back(server_.shard(any_pair()));
    return shards_.back();
  }
  void operate() {
    const double what = uniform();
    if (what < 0.5) {
      const HeardFrame frame = say();
      if (chance(lossy_)) return;
      deliver(frame);
    } else if (what < 0.6 && !said_.empty()) {
      deliver(said_[below(said_.size())]);
    } else if (what < 0.68) {
      const HeardShard shard = keep_shard();
      if (chance(0.6)) hear(shard);
    } else if (what < 0.72 && !shards_.empty()) {
      hear(shards_[below(shards_.size())]);
    } else if (what < 0.8) {
      deliver_foreign(decorated(Model(0).began(any_pair())), true);
      if (!old_said_.empty()) deliver_foreign(old_said_[below(old_said_.size())], false);
      deliver_foreign(Model(0).bookmark(), true);
      deliver_foreign(Model(0).shard(any_pair()), true);
    } else if (what < 0.85 && !server_.contacts().empty()) {
      const auto contact =
          std::next(server_.contacts().begin(), static_cast<std::ptrdiff_t>(below(server_.contacts().size())));
      persisted_.push_back(decorated(server_.persisted(contact->first)));
      state_.hear_persisted(persisted_.back());
    } else if (what < 0.855 && heard_any_) {
      restart();
      hear(server_.bookmark(false));
    } else if (what < 0.9) {
      hear(server_.bookmark());
      heard_any_ = true;
    }
  }
  /// All shards, old ones behind the new, and two bookmarks: what was told is what holds, now and not later.
  void settle() {
    for (std::uint32_t shard = 0; shard < wire_contract::kContactShards; ++shard) {
      hear(server_.shard(static_cast<std::uint8_t>(shard)));
      if (!shards_.empty()) hear(shards_[below(shards_.size())]);
      deliver_foreign(Model(0).shard(static_cast<std::uint8_t>(shard)), true);
    }
    hear(server_.bookmark());
    hear(server_.bookmark());
    heard_any_ = true;
    std::map<std::pair<std::string, std::string>, Told> truth;
    for (const auto& [pair, episode] : server_.contacts()) {
      const std::string a = std::to_string(pair.first), b = std::to_string(pair.second);
      truth[std::minmax(a, b)] = {epoch_, episode};
    }
    std::set<std::pair<std::string, std::string>> told_pairs, true_pairs;
    for (const auto& [names, told] : open_) told_pairs.insert(names);
    for (const auto& [names, told] : truth) true_pairs.insert(names);
    EXPECT_EQ(told_pairs, true_pairs);
    EXPECT_TRUE(state_.in_step());
    heard_through_ = server_.bookmark().last_event_sequence;
    open_ = truth;  // a contact that was carried into this life has another episode here
    if (!log_.empty()) last_told_ = std::min(last_told_, log_.rbegin()->first);
  }

  std::mt19937_64 random_{0};
  Model server_{1};
  std::uint64_t epoch_ = 1, last_epoch_ = 0, last_told_ = 0, heard_through_ = 0;
  std::int64_t clock_ = 0;
  std::map<std::uint64_t, Event> log_;  // of this life, by sequence
  std::vector<HeardFrame> said_, old_said_;
  std::vector<HeardFrame> persisted_;
  std::vector<HeardShard> shards_;
  struct Told {
    std::uint64_t epoch = 0, episode = 0;
  };
  std::map<std::pair<std::string, std::string>, Told> open_;
  std::size_t told_count_ = 0;
  bool heard_any_ = false;
  double lossy_ = 0.1;
  client::Clock::time_point now_{std::chrono::milliseconds(1'000)};
  WatchState state_{[this](const Event& event) { emit(event); }};
};

TEST_F(WatchTwin, WhateverPeersRepeatReorderAndLoseWhatIsToldIsWhatWasSaid) {
  random_ = oracle::seeded(175);
  for (int round = 0; round < rounds_asked(300) && !HasFailure(); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    lossy_ = round % 2 == 0 ? 0 : 0.1;
    for (int i = 0; i < 100 && !HasFailure(); ++i) operate();
    settle();
  }
}

}  // namespace
}  // namespace collided
