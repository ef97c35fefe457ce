#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace collided::client {

/// Waits actively for an event that mostly arrives within microseconds, before the caller sleeps: waking up would take
/// longer.
///
/// It yields the processor, since the thread with the answer may need it; a pause instruction is 1 to 3 us slower per
/// round trip on two processors. After a wait in vain it skips the next waits, twice as many each time, and hundreds if
/// another process took and kept the processor. Thus a loaded or single-processor machine loses less than a hundredth
/// of a round trip's time.
///
/// threads  any
class ShortSpin {
 public:
  /// Returns when arrived() is true, after 80 us, at the deadline, or at once if it skips.
  template <class Arrived>
  void wait(std::chrono::steady_clock::time_point deadline, const Arrived& arrived) {
    if (skip_.load(std::memory_order_relaxed) > 0) {
      skip_.fetch_sub(1, std::memory_order_relaxed);
      return;
    }
    auto now = std::chrono::steady_clock::now();
    const auto end = std::min(deadline, now + kLongest);
    while (!arrived() && now < end) {
      std::this_thread::yield();
      now = std::chrono::steady_clock::now();
    }
    const int before = in_vain_.load(std::memory_order_relaxed);
    if (now < end) {
      in_vain_.store(std::max(before / 2, 1), std::memory_order_relaxed);
      return;
    }
    const bool taken_away = now - end > kLongest;
    const int in_vain = taken_away ? std::clamp(2 * before, kMostSkipped, kMostSkippedIfTaken)
                                   : std::max(before, std::min(2 * before, kMostSkipped));
    in_vain_.store(in_vain, std::memory_order_relaxed);
    skip_.store(in_vain, std::memory_order_relaxed);
  }

 private:
  static constexpr std::chrono::microseconds kLongest{80};
  static constexpr int kMostSkipped = 256;
  static constexpr int kMostSkippedIfTaken = 4'096;

  std::atomic<int> in_vain_{1};  // waits to skip after the next one in vain
  std::atomic<int> skip_{std::thread::hardware_concurrency() > 1 ? 0 : 1 << 30};
};

}  // namespace collided::client
