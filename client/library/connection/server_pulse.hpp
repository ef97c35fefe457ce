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

/// The word for a ServerState of the wire.
std::string state_name(std::uint8_t state);

/// A status as users see it, with an age of 0.
ServerStatus decode_status(const wire::Status& status);

/// Which server a connection talks to, its newest status, and how long it has been silent.
///
/// threads  any; hear() is for the status reader's callback, and before that counts for whoever greets
class ServerPulse {
 public:
  using Observer = std::function<void(const wire::Status&)>;

  /// Takes a status. That of another server counts only where it is an heir's, so that two servers on one namespace are
  /// not mixed up.
  void hear(dds::Sample<wire::Status>& status);
  /// Whether the status is that of a server that has taken the place of the known one, which is silent. A smaller epoch
  /// is an earlier server's, which may have been stopped and goes on: it counts only once nobody else has spoken for long.
  bool is_heir(const wire::Status& status) const;
  /// Any message of the server shows that it is alive, too.
  void hear_message() { last_heard_ns_.store(now_ns(), std::memory_order_relaxed); }
  /// This server has answered hello.
  void greeted(std::uint64_t server, std::uint64_t epoch);

  /// The server's number; 0 before anything was heard.
  std::uint64_t server() const { return server_.load(std::memory_order_acquire); }
  /// That server's epoch. What has a smaller one is of the past.
  std::uint64_t epoch() const { return epoch_.load(std::memory_order_relaxed); }
  Clock::time_point last_heard() const;
  /// The server's process, on its machine; 0 before the first status.
  std::uint32_t pid() const { return pid_.load(std::memory_order_relaxed); }
  /// Whether it says that everything is there that it knows of.
  bool is_ready() const { return is_ready_.load(std::memory_order_relaxed); }
  /// Whether nothing has been heard for kStatusLostNs.
  bool silent() const;
  /// Whether its world has been at one step for longer than kStatusLostNs, by the newest status: it lives, and applies
  /// nothing meanwhile.
  bool is_busy() const { return is_busy_.load(std::memory_order_relaxed); }
  /// When its world was busy last, by its statuses.
  Clock::time_point last_busy() const;
  /// Whether another server may have taken the known one's place.
  bool may_have_heir() const;
  /// How often no status came for so long (wire_contract::kForgottenNs) that DDS may have forgotten the server's
  /// readers, and with them what they had yet to receive.
  std::uint64_t outages() const { return outages_.load(std::memory_order_acquire); }

  /// The newest status; nothing before the first one.
  std::optional<ServerStatus> status() const;
  /// A publisher according to the newest status; nothing where it does not have it.
  struct PublisherView {
    std::uint64_t applied_sequence = 0;
    bool lost = false;
    bool asked = false;  // to define everything again
  };
  std::optional<PublisherView> publisher(std::uint64_t publisher) const;
  /// Waits for the next status; false where `deadline` comes first.
  bool wait_for_status(Clock::time_point deadline) const;

  /// Calls the observer with every status that counts, on DDS's receive thread. Returns its number for stop_observing.
  int observe(Observer observer);
  /// Removes an observer. When this returns, it is not running and will not run.
  void stop_observing(int observer);

 private:
  static std::int64_t now_ns() { return Clock::now().time_since_epoch().count(); }

  std::atomic<std::int64_t> last_heard_ns_{0};
  std::atomic<std::int64_t> last_busy_ns_{0};
  std::atomic<bool> is_busy_{false};
  std::atomic<std::uint64_t> server_{0};
  std::atomic<std::uint64_t> epoch_{0};
  std::atomic<bool> is_stopping_{false};
  std::atomic<bool> is_ready_{false};
  std::atomic<std::uint32_t> pid_{0};
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
