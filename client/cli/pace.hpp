#pragma once

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>

#include "client/cli/io.hpp"

namespace collided::cli {

/// Sleeps until a time on the steady clock. False if it was interrupted.
inline bool sleep_until(std::chrono::steady_clock::time_point when) {
  constexpr std::chrono::milliseconds kInterruptCheck{50};
  while (!stop_requested) {
    const auto now = std::chrono::steady_clock::now();
    if (now >= when) return true;
    std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(when - now, kInterruptCheck));
  }
  return false;
}

/// When a run ends: after a count (0: any), after a time, or when interrupted.
class Until {
 public:
  using Clock = std::chrono::steady_clock;
  Until(std::uint64_t most_count, std::chrono::nanoseconds most_time) : most_count_(most_count) {
    constexpr std::chrono::hours kForever{24 * 365 * 100};
    end_ = Clock::now() + std::min<std::chrono::nanoseconds>(most_time, kForever);
  }
  /// Whether the run is over, after this many results.
  bool reached(std::uint64_t count) const {
    return stop_requested || (most_count_ > 0 && count >= most_count_) || Clock::now() >= end_;
  }
  /// The end time; a hundred years from the start if it is unlimited.
  Clock::time_point end() const { return end_; }

 private:
  std::uint64_t most_count_;
  Clock::time_point end_;
};

/// The next item of a watch; nothing if none comes within 50 ms or before the end. Output is flushed before it waits.
template <class Watched>
auto next_of(Watched& watch, Io& io, const Until& until) -> decltype(watch.next(std::chrono::nanoseconds(0))) {
  if (auto next = watch.next(std::chrono::nanoseconds(0))) return next;
  io.out.flush();
  constexpr std::chrono::milliseconds kInterruptCheck{50};
  const std::chrono::nanoseconds left = until.end() - Until::Clock::now();
  return watch.next(std::clamp<std::chrono::nanoseconds>(left, std::chrono::nanoseconds(0), kInterruptCheck));
}

}  // namespace collided::cli
