#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#include "client/library/connection/server_pulse.hpp"
#include "collided/events.hpp"

namespace collided::client {

/// What the events of a Watch on the fences' topics mean.
///
/// threads  any
template <class News>
class InterpretedWatch : public Subscription<News>::Source {
 public:
  /// Appends what an event means, which may be nothing.
  using Interpret = std::function<void(const Event&, std::deque<News>&)>;
  InterpretedWatch(Watch watch, Interpret interpret) : watch_(std::move(watch)), interpret_(std::move(interpret)) {}

  std::optional<News> next(std::chrono::nanoseconds wait) override {
    const Clock::time_point until =
        Clock::now() + std::min<std::chrono::nanoseconds>(wait, std::chrono::hours(24 * 365));
    const std::lock_guard lock(mutex_);
    while (waiting_.empty()) {
      const auto left = std::max<std::chrono::nanoseconds>(until - Clock::now(), std::chrono::nanoseconds(0));
      const std::optional<Event> event = watch_.next(left);
      if (!event) return std::nullopt;
      interpret_(*event, waiting_);
    }
    News news = std::move(waiting_.front());
    waiting_.pop_front();
    return news;
  }
  SubscriptionHealth health() const override { return watch_.health(); }

 private:
  Watch watch_;
  std::mutex mutex_;  // for the rest
  Interpret interpret_;
  std::deque<News> waiting_;
};

}  // namespace collided::client
