#pragma once

#include <ctime>

namespace collided::bench {

/// Processor time of the calling thread: what others run on the machine does not count, but for the caches they share.
inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace collided::bench
