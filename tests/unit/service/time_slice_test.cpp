#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <thread>

#include "server/service/questions/time_slice.hpp"

namespace collided::engine::service {
namespace {

struct Scheduling {
  std::uint32_t policy = 99;
  std::int32_t nice = 99;
  std::uint64_t runtime_ns = 0;
};

Scheduling of_this_thread() {
  std::array<unsigned char, 48> bytes{};
  EXPECT_EQ(syscall(SYS_sched_getattr, 0, bytes.data(), bytes.size(), 0U), 0);
  Scheduling scheduling;
  std::memcpy(&scheduling.policy, &bytes[4], sizeof scheduling.policy);
  std::memcpy(&scheduling.nice, &bytes[16], sizeof scheduling.nice);
  std::memcpy(&scheduling.runtime_ns, &bytes[24], sizeof scheduling.runtime_ns);
  return scheduling;
}

// Of a thread of its own, so that the rest of the tests keep what they have.
TEST(Turns, AreThoseOfWhoAsksAndOfWhomItStarts) {
  std::thread([] {
    const Scheduling before = of_this_thread();
    if (before.runtime_ns == 0) GTEST_SKIP() << "a kernel before 6.12 has turns of one length for all";
    ASSERT_TRUE(set_time_slice(kShortSlice));
    std::thread([&] {
      const Scheduling after = of_this_thread();
      EXPECT_EQ(after.runtime_ns, 100'000U);
      EXPECT_LT(after.runtime_ns, before.runtime_ns);
      EXPECT_EQ(after.policy, before.policy);
      EXPECT_EQ(after.nice, before.nice);
      ASSERT_TRUE(set_time_slice(kLongSlice));
      EXPECT_EQ(of_this_thread().runtime_ns, 20'000'000U);
    }).join();
    EXPECT_EQ(of_this_thread().runtime_ns, 100'000U);
  }).join();
}

// Whoever chose another policy for the server keeps it.
TEST(Turns, LeaveAnotherPolicyAlone) {
  std::thread([] {
    const sched_param none{};
    ASSERT_EQ(sched_setscheduler(0, SCHED_BATCH, &none), 0);
    EXPECT_FALSE(set_time_slice(kShortSlice));
    EXPECT_EQ(sched_getscheduler(0), SCHED_BATCH);
  }).join();
}

}  // namespace
}  // namespace collided::engine::service
