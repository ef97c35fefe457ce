#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace collided::client {

/// Waiting for something that mostly comes within microseconds, before going to sleep for it: being woken costs more than
/// the answer takes. The processor is offered to others all the while, since one of them may be the thread that brings
/// it: pausing instead was 1 to 3 us slower a round trip on two processors. Where it was in vain the next waits sleep at
/// once, twice as many each time; where somebody else took the processor and kept it, hundreds do: a loaded machine and
/// a single processor lose nothing that a hundredth of the round trips would show.
/// Any thread.
class ShortSpin {
 public:
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

  std::atomic<int> in_vain_{1};
  std::atomic<int> skip_{std::thread::hardware_concurrency() > 1 ? 0 : 1 << 30};
};

}  // namespace collided::client
