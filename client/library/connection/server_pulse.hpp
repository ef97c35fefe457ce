#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>

#include "collided/client.hpp"
#include "idl/dds.hpp"

namespace collided::client {

using Clock = std::chrono::steady_clock;

/// Which server this connection talks to, its newest status, and since when it has been silent.
/// Any thread; hear() is for the status reader's callback.
class ServerPulse {
 public:
  using Observer = std::function<void(const wire::Status&)>;

  /// Takes a status. One of another server counts only while the known one is silent: two servers on one namespace
  /// must not be mixed.
  void hear(dds::Sample<wire::Status>& status);
  /// A reply is a sign of life too.
  void hear_reply() { last_heard_ns_.store(now_ns(), std::memory_order_relaxed); }
  /// The server that answered hello.
  void greeted(std::uint64_t server);

  /// 0 before the first word.
  std::uint64_t server() const { return server_.load(std::memory_order_acquire); }
  Clock::time_point last_heard() const;
  bool silent() const;
  /// How often statuses stayed away for so long that DDS may have forgotten the server's readers meanwhile, and with them
  /// what they lacked (wire_contract::kForgottenNs).
  std::uint64_t outages() const { return outages_.load(std::memory_order_acquire); }

  /// Empty before the first status.
  std::optional<ServerStatus> status() const;
  /// How the newest status sees a publisher; nothing when it does not know it.
  struct PublisherView {
    std::uint64_t applied_sequence = 0;
    bool lost = false;
  };
  std::optional<PublisherView> publisher(std::uint64_t publisher) const;
  /// Waits for the next status after this call.
  bool wait_for_status(Clock::time_point deadline) const;

  /// Runs on the receive thread at every status that counts; returns what stop_observing takes.
  int observe(Observer observer);
  /// After it returned, the observer does not run.
  void stop_observing(int observer);

 private:
  static std::int64_t now_ns() { return Clock::now().time_since_epoch().count(); }

  std::atomic<std::int64_t> last_heard_ns_{0};
  std::atomic<std::uint64_t> server_{0};
  std::atomic<std::uint64_t> outages_{0};
  mutable std::mutex mutex_;
  mutable std::condition_variable came_;
  dds::Sample<wire::Status> newest_;
  std::uint64_t count_ = 0;
  Clock::time_point newest_came_;
  std::mutex observers_mutex_;
  std::map<int, Observer> observers_;
  int next_observer_ = 0;
};

}  // namespace collided::client
