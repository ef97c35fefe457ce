#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "idl/dds.hpp"
#include "server/service/ask.hpp"

namespace collided::service {

/// One asking client: its reply writer in its own partition, and what waits until somebody there listens.
class Client {
 public:
  explicit Client(std::uint64_t id) : id_(id) {}
  std::uint64_t id() const { return id_; }
  /// False: nobody took it, or nobody is there any more.
  [[nodiscard]] bool write(const wire::Reply& reply);
  /// The newest version of the world that an answer to it was about; any thread.
  std::uint64_t told_version() const { return told_version_.load(std::memory_order_relaxed); }
  void note_told(std::uint64_t version);

 private:
  friend class Clients;
  bool ready() const { return open_.load(std::memory_order_acquire) && listening_.load(); }

  const std::uint64_t id_;
  std::mutex mutex_;
  std::optional<dds::Writer<wire::Reply>> writer_;
  std::vector<AskPointer> waiting_;
  std::atomic<bool> open_{false};  // the writer is in its place, for good
  std::atomic<bool> listening_{false};
  std::atomic<std::uint64_t> asker_{0};  // its query writer
  std::atomic<std::int64_t> deaf_since_ns_{0};
  std::atomic<std::uint64_t> told_version_{0};
};

/// Every client that has asked and still lives. A reply written before the client's reader was matched would be lost,
/// so asks wait for the match.
///
/// threads  any but DDS's own, which may call find_ready() alone: making and deleting writers inside a listener would
///          deadlock
class Clients {
 public:
  static constexpr std::size_t kMost = 1'000;
  static constexpr std::size_t kMostWaiting = 256;  // asks of one client
  static constexpr std::int64_t kMatchPatienceNs = 1'000'000'000;
  static constexpr std::int64_t kDeafPatienceNs = 10'000'000'000;  // a client without a reader is forgotten

  /// listening  called on DDS's thread when a client's asks may go on: hand resume() to a worker
  Clients(const dds::Topic<wire::Reply>& topic, std::function<void(std::uint64_t)> listening)
      : topic_(topic), listening_(std::move(listening)) {}

  /// The client of an ask; made when it is first seen; null when kMost are there.
  std::shared_ptr<Client> meet(std::uint64_t id, std::uint64_t asker);
  std::shared_ptr<Client> find(std::uint64_t id) const;
  /// The client of an ask if its replies can be written at once, else null. For the one listener of questions.
  /// lock  none for a client that asked before and shares its place with no other
  Client* find_ready(std::uint64_t id, std::uint64_t asker);
  /// Takes the ask where it must wait.
  bool hold(Client& client, AskPointer& ask);
  std::vector<AskPointer> resume(std::uint64_t id);
  /// Deletes clients whose query writer is gone; returns asks that waited too long.
  std::vector<AskPointer> sweep(std::span<const std::uint64_t> askers, std::int64_t now_ns);
  std::size_t size() const;

 private:
  static constexpr std::size_t kRecent = 16;

  void open_writer(const std::shared_ptr<Client>& client);
  void bury();

  const dds::Topic<wire::Reply>& topic_;
  std::function<void(std::uint64_t)> listening_;
  mutable std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<Client>> clients_;
  std::vector<std::shared_ptr<Client>> gone_;   // until nobody holds them, so that no listener deletes a writer
  std::atomic<std::uint64_t> departures_{0};    // sweeps that found clients gone
  std::array<std::shared_ptr<Client>, kRecent> recent_;  // the listener's own, by number
  std::uint64_t recent_departures_ = 0;         // as of when they were looked up
};

}  // namespace collided::service
