#include "server/service/events/heartbeat.hpp"

#include <chrono>
#include <utility>

#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {

Heartbeat::Heartbeat(std::function<std::int64_t(std::int64_t)> beat) : beat_(std::move(beat)) {
  thread_ = named_thread("heartbeat", [this] { run(); });
}

Heartbeat::~Heartbeat() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  ends_.notify_one();
  thread_.join();
}

void Heartbeat::run() {
  std::int64_t next_ns = steady_ns();
  std::unique_lock lock(mutex_);
  const auto is_over = [this] { return is_over_; };
  while (!ends_.wait_until(lock, std::chrono::steady_clock::time_point(std::chrono::nanoseconds(next_ns)), is_over)) {
    lock.unlock();
    next_ns = beat_(steady_ns());
    lock.lock();
  }
}

}  // namespace collided::engine::service
