#include "server/service/events/heartbeat.hpp"

#include <chrono>
#include <utility>

#include "idl/topics.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {

Heartbeat::Heartbeat(std::function<void(std::int64_t)> beat) : beat_(std::move(beat)) {
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
  constexpr std::chrono::nanoseconds kPeriod(wire_contract::kStatusPeriodNs / 2);
  std::unique_lock lock(mutex_);
  while (!ends_.wait_for(lock, kPeriod, [this] { return is_over_; })) {
    lock.unlock();
    beat_(steady_ns());
    lock.lock();
  }
}

}  // namespace collided::engine::service
