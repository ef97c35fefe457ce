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

/// The server of a connection, its newest status, and the duration of its silence.
///
/// threads  any; hear() is for the status reader's callback, and before the first greeting for the greeting thread
class ServerPulse {
 public:
  using Observer = std::function<void(const wire::Status&)>;

  /// Takes a status. Another server's counts only if that is an heir, so that two servers on one namespace are not
  /// mixed up.
  void hear(dds::Sample<wire::Status>& status);
  /// True if the status is from a server that has replaced the known one, which is silent. A smaller epoch is that of
  /// an earlier server, which may have been suspended and resumed: it counts only after a long silence of all others.
  bool is_heir(const wire::Status& status) const;
  /// Notes another message of the server, which also shows that it is alive.
  void hear_message() { last_heard_ns_.store(now_ns(), std::memory_order_relaxed); }
  /// Notes the server that has answered hello.
  void greeted(std::uint64_t server, std::uint64_t epoch);

  /// The server's number; 0 before the first message.
  std::uint64_t server() const { return server_.load(std::memory_order_acquire); }
  /// That server's epoch. Messages with a smaller one are outdated.
  std::uint64_t epoch() const { return epoch_.load(std::memory_order_relaxed); }
  Clock::time_point last_heard() const;
  /// The server's process, on its machine; 0 before the first status.
  std::uint32_t pid() const { return pid_.load(std::memory_order_relaxed); }
  /// True if it reports the state `ready`.
  bool is_ready() const { return is_ready_.load(std::memory_order_relaxed); }
  /// True if there was no message for kStatusLostNs.
  bool silent() const;
  /// True if, by the newest status, its world has been in one step for longer than kStatusLostNs: the server is alive,
  /// but applies nothing meanwhile.
  bool is_busy() const { return is_busy_.load(std::memory_order_relaxed); }
  /// When its world was last busy, by its statuses.
  Clock::time_point last_busy() const;
  /// True if another server may have replaced the known one.
  bool may_have_heir() const;
  /// Number of gaps between statuses so long (wire_contract::kForgottenNs) that DDS may have dropped the server's
  /// readers and the messages in flight to them.
  std::uint64_t outages() const { return outages_.load(std::memory_order_acquire); }

  /// World time up to which the server has decided every contact, by the newest status; 0 before the first one.
  std::chrono::nanoseconds settled() const;
  /// The newest status; nothing before the first one.
  std::optional<ServerStatus> status() const;
  /// A publisher according to the newest status; nothing if it is not listed.
  struct PublisherView {
    std::uint64_t applied_sequence = 0;
    bool lost = false;
    bool asked = false;  // the server requests that it define everything again
  };
  std::optional<PublisherView> publisher(std::uint64_t publisher) const;
  /// Waits for the next status; false if `deadline` comes first.
  bool wait_for_status(Clock::time_point deadline) const;

  /// Calls the observer with every accepted status, on DDS's receive thread. Returns its number for stop_observing.
  int observe(Observer observer);
  /// Removes an observer. After the return it is not running and will not run.
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
