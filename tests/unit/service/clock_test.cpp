#include "server/service/runtime/clock.hpp"

#include <gtest/gtest.h>

namespace collided::engine::service {
namespace {

// Publishers stamp by the machine's clock; world time must be of the same years, and never go back.
TEST(WorldClock, IsThatOfTheMachineWhenItStarted) {
  using std::chrono::system_clock;
  const auto machine_ns = [] {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(system_clock::now().time_since_epoch()).count();
  };
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  const WorldClock clock;
  EXPECT_GT(clock.now_ns(), machine_ns() - kSecondNs);
  EXPECT_LT(clock.now_ns(), machine_ns() + kSecondNs);
  std::int64_t last_ns = clock.now_ns();
  for (int i = 0; i < 1'000; ++i) {
    const std::int64_t now_ns = clock.now_ns();
    ASSERT_GE(now_ns, last_ns);
    last_ns = now_ns;
  }
}

}  // namespace
}  // namespace collided::engine::service
