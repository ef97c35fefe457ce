#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

namespace collided::engine::service {

/// Calls a function at the times that it names, on a thread that does nothing else: however long a step of the world
/// takes, the server shows that it lives.
class Heartbeat {
 public:
  /// beat  takes the steady clock's time and returns when it is to be called again; it must neither wait nor work for
  ///       long
  explicit Heartbeat(std::function<std::int64_t(std::int64_t now_ns)> beat);
  /// The function does not run any more when this returns.
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
