#include "server/service/events/untold_events.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace collided::engine::service {
namespace {

constexpr std::int64_t kOneSecond = 1'000'000'000;

EventColumns events_of(std::uint64_t first, std::size_t count) {
  EventColumns events;
  events.first_sequence = first;
  events.kinds.resize(count);
  events.bracket_lows.resize(count);
  return events;
}

/// One event whose bracket begins so long before the frame's time.
EventColumns event_from_ago(std::uint64_t number, double ago_s) {
  EventColumns events = events_of(number, 1);
  events.bracket_lows[0] = ago_s;
  return events;
}

using UntoldContacts = UntoldEvents<EventColumns>;

std::vector<std::uint64_t> told(UntoldContacts& untold, std::int64_t heard_ns, std::int64_t same_from_ns = 0) {
  std::vector<std::uint64_t> first;
  untold.tell_all({.heard_ns = heard_ns, .same_from_ns = same_from_ns},
                  [&](const UntoldContacts::UntoldFrame& frame) { first.push_back(frame.events.first_sequence); });
  return first;
}

TEST(UntoldEvents, AreToldFromBeforeTheOtherOneFellSilentHoweverLongThatWas) {
  UntoldContacts untold;
  for (std::int64_t second = 1; second <= 60; ++second) {
    untold.keep(events_of(static_cast<std::uint64_t>(second), 1), {}, second * kOneSecond);
  }
  // Silent since second 20 and a bit: the place is taken 40 s later.
  const std::vector<std::uint64_t> all = told(untold, 20 * kOneSecond + kOneSecond / 2);
  ASSERT_EQ(all.size(), 42U);
  EXPECT_EQ(all.front(), 19U);
  EXPECT_EQ(all.back(), 60U);
  EXPECT_TRUE(told(untold, 0).empty()) << "they are told once";
}

TEST(UntoldEvents, AllAreToldWhereNobodyWasHeard) {
  UntoldContacts untold;
  untold.keep(events_of(7, 3), {}, kOneSecond);
  untold.keep(events_of(10, 1), {}, 100 * kOneSecond);
  EXPECT_EQ(told(untold, 0), (std::vector<std::uint64_t>{7, 10}));
}

TEST(UntoldEvents, AsManyAreKeptAsASubscriberRemembersThatItHasHeard) {
  constexpr std::size_t kMost = wire_contract::kEventTopic.keep_last;
  UntoldContacts untold;
  for (std::uint64_t i = 0; i < 3 * kMost; ++i) untold.keep(events_of(i, 1), {}, kOneSecond);
  const std::vector<std::uint64_t> all = told(untold, kOneSecond);
  ASSERT_EQ(all.size(), kMost);
  EXPECT_EQ(all.front(), 2 * kMost);
}

TEST(UntoldEvents, WhatASecondServerFoundBeforeItHeldTheSameWorldIsNotTold) {
  UntoldContacts untold;
  const auto keep = [&](std::uint64_t number, double ago_s) {
    untold.keep(event_from_ago(number, ago_s), {.world_time_ns = static_cast<std::int64_t>(number) * kOneSecond},
                kOneSecond);
  };
  keep(1, 0.5);
  keep(2, 0.5);
  keep(3, 1.5);  // from before second 2
  keep(4, 0.5);
  keep(5, 0.5);
  EXPECT_EQ(told(untold, kOneSecond, 2 * kOneSecond), (std::vector<std::uint64_t>{4, 5}));
}

TEST(UntoldEvents, NothingIsToldOfAWorldThatIsNotTheSame) {
  UntoldContacts untold;
  untold.keep(event_from_ago(1, 0), {.world_time_ns = kOneSecond}, kOneSecond);
  EXPECT_TRUE(told(untold, 0, std::numeric_limits<std::int64_t>::max()).empty());
}

TEST(UntoldEvents, FramesWithoutEventsAreNotKept) {
  UntoldContacts untold;
  untold.keep(events_of(1, 0), {}, kOneSecond);
  EXPECT_TRUE(told(untold, 0).empty());
}

}  // namespace
}  // namespace collided::engine::service
