#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace collided::client {

/// Waiting for something that mostly comes within microseconds, before going to sleep for it: waking a thread on
/// another processor costs more than the answer takes. Where that was in vain the next waits sleep at once, twice as
/// many each time, so that a loaded machine and a single processor lose nothing.
/// Any thread.
class ShortSpin {
 public:
  template <class Arrived>
  void wait(std::chrono::steady_clock::time_point deadline, const Arrived& arrived) {
    if (skip_.load(std::memory_order_relaxed) > 0) {
      skip_.fetch_sub(1, std::memory_order_relaxed);
      return;
    }
    const auto end = std::min(deadline, std::chrono::steady_clock::now() + kLongest);
    while (!arrived()) {
      if (std::chrono::steady_clock::now() >= end) {
        in_vain_.store(std::min(2 * in_vain_.load(std::memory_order_relaxed), kMostSkipped), std::memory_order_relaxed);
        skip_.store(in_vain_.load(std::memory_order_relaxed), std::memory_order_relaxed);
        return;
      }
      for (int i = 0; i < kPauses; ++i) pause();
    }
    in_vain_.store(1, std::memory_order_relaxed);
  }

 private:
  static constexpr std::chrono::microseconds kLongest{80};
  static constexpr int kMostSkipped = 256;
  static constexpr int kPauses = 8;

  static void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    asm volatile("yield");
#endif
  }

  std::atomic<int> in_vain_{1};
  std::atomic<int> skip_{std::thread::hardware_concurrency() > 1 ? 0 : 1 << 30};
};

}  // namespace collided::client
