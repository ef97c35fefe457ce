#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

namespace collided::engine::service {

/// Calls a function at the times that it returns, on a thread of its own: the server shows that it lives even during a
/// long step of the world.
class Heartbeat {
 public:
  /// beat  takes the steady clock's time and returns its next call time; it must neither wait nor take long
  explicit Heartbeat(std::function<std::int64_t(std::int64_t now_ns)> beat);
  /// The function no longer runs when this returns.
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

 private:
  void run();

  const std::function<std::int64_t(std::int64_t)> beat_;
  std::mutex mutex_;
  std::condition_variable ends_;
  bool is_over_ = false;
  std::thread thread_;
};

}  // namespace collided::engine::service
