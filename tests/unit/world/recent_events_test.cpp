// The newest events, kept for whoever asks about one.
#include "server/world/events/recent_events.hpp"

#include <gtest/gtest.h>

namespace collided::engine::recent_events_test {
namespace {

Event numbered(std::uint64_t sequence, ObjectId b = 2) {
  Event event;
  event.sequence = sequence;
  event.of.a = 1;
  event.of.b = b;
  event.bracket_low_s = 0.5;
  event.bracket_high_s = 0.25;
  return event;
}

TEST(RecentEvents, WhatIsOlderThanTheNewestIsForgotten) {
  RecentEvents events;
  EXPECT_FALSE(events.find(1));
  EXPECT_EQ(events.span().last, 0u);
  for (std::uint64_t i = 1; i <= RecentEvents::kMost + 3; ++i) events.note(numbered(i), 10, "a", std::to_string(i));
  EXPECT_EQ(events.span().first, 4u);
  EXPECT_EQ(events.span().last, RecentEvents::kMost + 3);
  EXPECT_FALSE(events.find(3));
  EXPECT_FALSE(events.find(RecentEvents::kMost + 4));
  EXPECT_EQ(events.find(4)->b, "4");
  EXPECT_EQ(events.find(RecentEvents::kMost + 3)->event.sequence, RecentEvents::kMost + 3);
}

TEST(RecentEvents, ThoseOfAFenceComeOldestFirst) {
  RecentEvents events;
  for (std::uint64_t i = 1; i <= 10; ++i) events.note(numbered(i, i % 2), 1'000'000'000, "a", "b");
  const std::vector<RecentEvent> last = events.last_of(1, 3);
  ASSERT_EQ(last.size(), 3u);
  EXPECT_EQ(last[0].event.sequence, 5u);
  EXPECT_EQ(last[2].event.sequence, 9u);
  EXPECT_EQ(last[0].low_ns(), 500'000'000);
  EXPECT_EQ(last[0].high_ns(), 750'000'000);
}

}  // namespace
}  // namespace collided::engine::recent_events_test
