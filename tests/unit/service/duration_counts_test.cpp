#include "server/service/runtime/duration_counts.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>

namespace collided::engine::service {
namespace {

// Every duration is in a step that begins at most an eighth below its end, and no step begins before the last one ended.
TEST(DurationCounts, AStepIsAtMostAnEighthWide) {
  std::int64_t begin = 0;
  for (std::size_t bucket = 0; begin <= DurationCounts::kLongest_ns; ++bucket) {
    const std::int64_t end = DurationCounts::longest_ns(bucket);
    ASSERT_GE(end, begin);
    EXPECT_EQ(DurationCounts::bucket_of(begin), bucket);
    EXPECT_EQ(DurationCounts::bucket_of(end), bucket);
    EXPECT_LE((end - begin) * 8, begin) << begin << " to " << end;
    begin = end + 1;
  }
  EXPECT_EQ(begin, DurationCounts::kLongest_ns + 1);
}

TEST(DurationCounts, WhatIsOutOfRangeCountsAtTheEnd) {
  DurationCounts counts;
  for (const std::int64_t ns : {INT64_MIN, std::int64_t{-1}, std::int64_t{0}, DurationCounts::kLongest_ns, INT64_MAX})
    counts.add(ns);
  std::map<std::int64_t, std::uint64_t> seen;
  counts.for_each([&](std::int64_t longest_ns, std::uint64_t count) { seen[longest_ns] = count; });
  EXPECT_EQ(seen, (std::map<std::int64_t, std::uint64_t>{{0, 3}, {DurationCounts::kLongest_ns, 2}}));
}

}  // namespace
}  // namespace collided::engine::service
