// What a publisher's stamps become in world time.
#include "server/service/ingest/source_clock.hpp"

#include <gtest/gtest.h>

namespace collided::engine::service {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kStart = 1'000'000 * kMs;

// The definitions of 20,000 objects are long on their way, and the first batch behind them. Another server that hears the
// publisher later never sees that: both come to the same time.
TEST(SourceClock, ABatchThatWasOnlyLateIsNoOtherClock) {
  SourceClock clock;
  EXPECT_EQ(clock.stamp(kStart, kStart + 900 * kMs).time_ns, kStart + 900 * kMs);
  EXPECT_EQ(clock.stamp(kStart + 10 * kMs, kStart + 905 * kMs).time_ns, kStart + 910 * kMs) << "late, too";
  const WorldStamp in_time = clock.stamp(kStart + 2'000 * kMs, kStart + 2'040 * kMs);
  EXPECT_EQ(in_time.time_ns, kStart + 2'000 * kMs);
  EXPECT_EQ(in_time.kind, StampKind::jumped) << "no motion connects the two";
  const WorldStamp next = clock.stamp(kStart + 2'020 * kMs, kStart + 2'060 * kMs);
  EXPECT_EQ(next.time_ns, kStart + 2'020 * kMs);
  EXPECT_EQ(next.kind, StampKind::good);
  EXPECT_TRUE(clock.behind_ns());
}

TEST(SourceClock, WorldTimeDoesNotFallWhereALateBatchWasTakenForAnotherClock) {
  SourceClock clock;
  const std::int64_t first_ns = clock.stamp(kStart, kStart + 900 * kMs).time_ns;
  const std::int64_t second_ns = clock.stamp(kStart + 600 * kMs, kStart + 920 * kMs).time_ns;
  EXPECT_GT(second_ns, first_ns);
  EXPECT_EQ(clock.stamp(kStart + 610 * kMs, kStart + 930 * kMs).kind, StampKind::late);
  EXPECT_EQ(clock.stamp(kStart + 1'000 * kMs, kStart + 1'040 * kMs).time_ns, kStart + 1'000 * kMs);
}

// It is on the clock of the batches, comes between them, and makes none of them late. A clock that has jumped is not followed.
TEST(SourceClock, ASignOfLifeSaysHowFarTheTimeHasComeAndNoMore) {
  SourceClock clock;
  EXPECT_FALSE(clock.alive_at(kStart, kStart)) << "before the first batch nothing is known of the clock";
  clock.stamp(kStart - 3'000 * kMs, kStart);
  EXPECT_EQ(clock.alive_at(kStart - 2'700 * kMs, kStart + 300 * kMs), kStart + 300 * kMs);
  EXPECT_EQ(clock.stamp(kStart - 2'800 * kMs, kStart + 310 * kMs).kind, StampKind::good);
  EXPECT_FALSE(clock.alive_at(kStart + 60'000 * kMs, kStart + 320 * kMs));
  EXPECT_FALSE(clock.alive_at(-1, kStart + 330 * kMs));
  EXPECT_EQ(clock.stamp(kStart - 2'600 * kMs, kStart + 510 * kMs).kind, StampKind::good);
}

TEST(SourceClock, AClockThatIsBehindKeepsItsOffset) {
  SourceClock clock;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t source_ns = kStart + i * 10 * kMs;
    const WorldStamp stamp = clock.stamp(source_ns, source_ns + 3'000 * kMs + (i % 7) * kMs);
    EXPECT_EQ(stamp.time_ns, source_ns + 3'000 * kMs);
    EXPECT_EQ(stamp.kind, StampKind::good);
  }
}

}  // namespace
}  // namespace collided::engine::service
