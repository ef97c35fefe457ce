#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "client/library/connection/server_pulse.hpp"

namespace collided::client {

/// A queue of events to be polled. When it is full, the oldest is dropped and counted.
///
/// threads  any
template <class News>
class EventQueue {
 public:
  explicit EventQueue(std::size_t capacity) : capacity_(std::max<std::size_t>(capacity, 1)) {}

  void push(News event) {
    {
      const std::lock_guard lock(mutex_);
      if (events_.size() >= capacity_) {
        events_.pop_front();
        ++lost_;
      }
      events_.push_back(std::move(event));
    }
    came_.notify_one();
  }
  std::optional<News> next(std::chrono::nanoseconds wait) {
    std::unique_lock lock(mutex_);
    // An infinite wait would overflow the clock, so it is limited to a year.
    const auto most = std::min<std::chrono::nanoseconds>(wait, std::chrono::hours(24 * 365));
    if (!came_.wait_until(lock, Clock::now() + most, [this] { return !events_.empty(); })) return std::nullopt;
    News event = std::move(events_.front());
    events_.pop_front();
    return event;
  }
  std::uint64_t lost() const {
    const std::lock_guard lock(mutex_);
    return lost_;
  }
  void grow(std::size_t by) {
    const std::lock_guard lock(mutex_);
    capacity_ += by;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable came_;
  std::deque<News> events_;
  std::size_t capacity_;
  std::uint64_t lost_ = 0;
};

}  // namespace collided::client
