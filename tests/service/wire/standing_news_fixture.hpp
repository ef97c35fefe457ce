#pragma once

#include "client/library/watching/standing_news.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "client/library/watching/watch_decoding.hpp"
#include "client/library/watching/watch_state.hpp"
#include "tests/service/wire/standing_messages.hpp"

namespace collided {

using test::StandingRow;
using test::StandingStay;

/// A watch that remembers what it reported, and checks that what holds begins and ends in turn, and that a change of the
/// nearest object names the one reported before.
class StandingNewsTest : public testing::Test {
 protected:
  using Kind = StandingEventKind;
  using Lines = std::vector<std::string>;
  static constexpr std::uint64_t kDrone = 1, kCrate = 2, kPerson = 3, kDoorA = 4, kDoorB = 5, kDoorC = 6;
  static constexpr std::uint64_t kDock = test::standing_id(1), kEscape = test::standing_id(2);
  static constexpr std::uint64_t kFar = test::standing_id(3), kNear = test::standing_id(4),
                                 kTouch = test::standing_id(5);
  static constexpr std::int64_t kStart_ns = 100'000'000'000;

  void hear(test::StandingFrameMessage frame) {
    const auto heard = client::decode(frame.message(), names_);
    ASSERT_TRUE(heard);
    state_.hear(*heard, now_ += std::chrono::milliseconds(1));
  }
  void hear(test::StandingShardMessage shard) {
    if (const auto sum = client::bookmark_in(shard.message()))
      return state_.hear(*sum, now_ += std::chrono::milliseconds(1));
    const auto heard = client::decode(shard.message(), names_);
    ASSERT_TRUE(heard);
    state_.hear(*heard, now_ += std::chrono::milliseconds(1));
  }
  /// A frame of one event at the start.
  void hear(std::uint64_t sequence, const StandingRow& row) { hear(server_.frame(kStart_ns, sequence, {row})); }
  void hear_sum(std::uint64_t as_of, const std::vector<StandingStay>& stays) {
    hear(server_.sum(kStart_ns, as_of, stays));
  }
  /// All shards and twice their sum, so that what was lost at the end is not waited for.
  void hear_state(std::uint64_t as_of, const std::vector<StandingStay>& stays) {
    std::map<std::uint8_t, std::vector<StandingStay>> shards;
    for (std::uint8_t number = 0; number < wire_contract::kContactShards; ++number) shards[number];
    for (const StandingStay& stay : stays)
      shards[wire_contract::contact_shard(stay.object, stay.standing)].push_back(stay);
    for (const auto& [number, held] : shards) hear(server_.shard(kStart_ns, number, as_of, held));
    for (int i = 0; i < 2; ++i) hear_sum(as_of, stays);
  }

  /// The events since the last call.
  std::vector<StandingEvent> take() { return std::exchange(events_, {}); }
  StandingEvent take_one() {
    const std::vector<StandingEvent> events = take();
    EXPECT_EQ(events.size(), 1U);
    return events.empty() ? StandingEvent() : events.front();
  }
  /// The same as lines: "enter drone dock", "near drone person 2 gap", "changed door_b (door_a) escape separated".
  Lines lines() {
    Lines lines;
    for (const StandingEvent& event : take()) lines.push_back(line_of(event));
    return lines;
  }
  static std::string line_of(const StandingEvent& event) {
    std::string line(name_of(event.kind));
    line += ' ' + (event.object.empty() ? "none" : event.object);
    if (event.form == StandingForm::bands) line += ' ' + event.other + ' ' + std::to_string(std::lround(event.band_m));
    else if (!event.other.empty()) line += " (" + event.other + ')';
    line += ' ' + event.standing;
    if (event.reason != EndReason::none) line += ' ' + std::string(name_of(event.reason));
    if (event.doubt != Doubt::none) line += " in doubt";
    return line + (event.resync ? " resync" : "");
  }

  client::Names names_;
  test::StandingServer server_{.names = {{kDrone, "drone"},
                                         {kCrate, "crate"},
                                         {kPerson, "person"},
                                         {kDoorA, "door_a"},
                                         {kDoorB, "door_b"},
                                         {kDoorC, "door_c"},
                                         {kDock, "dock"},
                                         {kEscape, "escape"},
                                         {kFar, "gap"},
                                         {kNear, "gap"},
                                         {kTouch, "gap"}}};
  client::WatchStateOf<client::StandingNews> state_{[this](const client::StandingNews& news) { emit(news); }};

 private:
  void emit(const client::StandingNews& news) {
    const bool is_right = news.kind == EventKind::ended ? holds_.erase(client::names_of(news)) == 1
                                                        : holds_.insert(client::names_of(news)).second;
    EXPECT_TRUE(is_right) << news.a << ' ' << news.b << ": begins or ends twice";
    const std::optional<StandingEvent> event = client::event_of(news);
    if (!event) return;
    if (event->form == StandingForm::nearest) {
      std::string& nearest = nearest_[event->standing];
      EXPECT_TRUE(event->kind != Kind::changed || event->other == nearest) << line_of(*event) << " after " << nearest;
      nearest = event->object;
    }
    events_.push_back(*event);
  }

  std::set<client::StandingNames> holds_;
  std::map<std::string, std::string> nearest_;
  std::vector<StandingEvent> events_;
  client::Clock::time_point now_{std::chrono::milliseconds(1'000)};
};

}  // namespace collided
