#pragma once

#include "client/library/watching/watch_state.hpp"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "tests/service/wire/watch_model.hpp"

namespace collided {

using client::Clock;
using client::HeardBookmark;
using client::HeardFrame;
using client::HeardShard;
using client::ServerLife;
using client::WatchState;
using std::chrono::milliseconds;
using test::Model;
using test::Pair;

inline constexpr const char* kWhat[] = {"open", "began", "persisted", "ended", "contained", "emerged"};

/// A watch that remembers what it was told, and checks that began and ended alternate, and contained and emerged between
/// them.
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
      EXPECT_FALSE(within_.contains(pair)) << "it did not emerge first";
    } else if (event.kind == EventKind::contained) {
      EXPECT_TRUE(open_.contains(pair) && within_.insert(pair).second) << "contained twice";
    } else if (event.kind == EventKind::emerged) {
      EXPECT_EQ(within_.erase(pair), 1u) << "it was not contained";
    } else if (event.kind != EventKind::persisted) {
      if (event.kind == EventKind::open && event.contained != Containment::none) within_.insert(pair);
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
  std::set<Pair> within_;
  Clock::time_point now_{milliseconds(1'000)};
  std::vector<std::string> reported_;
  std::vector<Event> events_;  // all that were told
  std::uint64_t last_epoch_ = 0;
  std::uint64_t last_sequence_ = 0;
  WatchState state_{[this](const Event& event) { emit(event); }};
};

using Lines = std::vector<std::string>;

/// The objects of a pair were defined anew: other ids, the same names, and which id is the lower may have changed.
inline HeardFrame redefined(HeardFrame frame, std::uint64_t a_id, std::uint64_t b_id, bool swaps_names) {
  Event& event = frame.entries.front().event;
  event.a_id = a_id;
  event.b_id = b_id;
  if (swaps_names) std::swap(event.a, event.b);
  return frame;
}

/// Numbers of its own in every field that a contact has.
inline Event with_numbers(Event event, double from) {
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
inline constexpr std::chrono::nanoseconds kFirstTouch{102'000'000'000 - 781'250'000};  // of with_numbers(began, 100)
inline HeardFrame with_numbers(HeardFrame frame, double from) {
  frame.entries.front().event = with_numbers(frame.entries.front().event, from);
  return frame;
}

inline void expect_numbers(const Event& event, const Event& expected) {
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

}  // namespace collided
