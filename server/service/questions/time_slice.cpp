#include "server/service/questions/time_slice.hpp"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>

namespace collided::engine::service {
namespace {

/// The kernel's struct sched_attr, which today's C libraries do not declare.
struct SchedulingAttributes {
  std::uint32_t size = sizeof(SchedulingAttributes);
  std::uint32_t policy = SCHED_OTHER;
  std::uint64_t flags = 0;
  std::int32_t nice = 0;
  std::uint32_t priority = 0;
  std::uint64_t runtime_ns = 0;
  std::uint64_t deadline_ns = 0;
  std::uint64_t period_ns = 0;
};
static_assert(sizeof(SchedulingAttributes) == 48);

}  // namespace

bool set_time_slice(std::chrono::nanoseconds turn) {
  // Another policy was set from outside of this program on purpose; it stays.
  if (sched_getscheduler(0) != SCHED_OTHER) return false;
  SchedulingAttributes attributes;
  attributes.runtime_ns = static_cast<std::uint64_t>(turn.count());
  attributes.nice = getpriority(PRIO_PROCESS, 0);
  return syscall(SYS_sched_setattr, 0, &attributes, 0U) == 0;
}

}  // namespace collided::engine::service
