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
#include "server/service/questions/ask.hpp"

namespace collided::engine::service {

/// A partition's reply writer, for all clients whose replies travel there; made for the first of them, and kept.
class ReplyPlace {
 public:
  bool ready() const { return open_.load(std::memory_order_acquire) && listening_.load(); }

 private:
  friend class Client;
  friend class Clients;

  std::optional<dds::Writer<wire::Reply>> writer_;
  std::atomic<bool> opening_{false};
  std::atomic<bool> open_{false};  // the writer is in its place, for good
  std::atomic<bool> listening_{false};
  std::atomic<std::int64_t> deaf_since_ns_{0};
};

/// One asking client, and what waits until somebody listens where its replies go.
class Client {
 public:
  Client(std::uint64_t id, ReplyPlace& place, std::int64_t met_ns) : id_(id), met_ns_(met_ns), place_(place) {}
  std::uint64_t id() const { return id_; }
  /// False: nobody took it, or nobody is there any more.
  [[nodiscard]] bool write(const wire::Reply& reply);
  /// The newest version of the world that an answer to it was about; any thread.
  std::uint64_t reported_version() const { return reported_version_.load(std::memory_order_relaxed); }
  void note_told(std::uint64_t version);

 private:
  friend class Clients;
  bool ready() const { return place_.ready(); }

  const std::uint64_t id_;
  const std::int64_t met_ns_;
  ReplyPlace& place_;
  std::mutex mutex_;
  std::vector<AskPointer> waiting_;
  std::atomic<std::uint64_t> asker_{0};  // its query writer
  std::atomic<std::uint64_t> reported_version_{0};
};

/// Every client that has asked and still lives. A reply written before a reader was matched would be lost, so asks wait for
/// the match; of several clients in one place for that of the first, and the library says hello until it is heard.
///
/// threads  any but DDS's own, which may call find_ready() alone: making writers inside a listener would deadlock
class Clients {
 public:
  static constexpr std::size_t kMost = 1'000;
  static constexpr std::size_t kMostWaiting = 256;  // asks of one client
  static constexpr std::int64_t kMatchPatienceNs = 1'000'000'000;
  static constexpr std::int64_t kDeafPatienceNs = 10'000'000'000;  // a client without a reader is forgotten

  /// listening  called on DDS's thread when asks of a place's clients may go on: hand resume() to a worker
  Clients(const dds::Topic<wire::Reply>& topic, std::function<void(std::uint32_t)> listening)
      : topic_(topic), listening_(std::move(listening)) {}

  /// The client of an ask; made when it is first seen; null when kMost are there.
  std::shared_ptr<Client> meet(std::uint64_t id, std::uint64_t asker);
  std::shared_ptr<Client> find(std::uint64_t id) const;
  /// The client of an ask if its replies can be written at once, else null. For the one listener of questions.
  /// lock  none for a client that asked before and shares its place with no other
  Client* find_ready(std::uint64_t id, std::uint64_t asker);
  /// Takes the ask where it must wait.
  bool hold(Client& client, AskPointer& ask);
  std::vector<AskPointer> resume(std::uint32_t place);
  /// Forgets clients whose query writer is gone; returns asks that waited too long.
  std::vector<AskPointer> sweep(std::span<const std::uint64_t> askers, std::int64_t now_ns);
  std::size_t size() const;

 private:
  static constexpr std::size_t kRecent = 16;

  void open(std::uint32_t place);

  const dds::Topic<wire::Reply>& topic_;
  std::function<void(std::uint32_t)> listening_;
  mutable std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<Client>> clients_;
  std::atomic<std::uint64_t> departures_{0};                        // sweeps that found clients gone
  std::array<std::shared_ptr<Client>, kRecent> recent_;             // the listener's own, by number
  std::uint64_t recent_departures_ = 0;                             // as of when they were looked up
  std::array<ReplyPlace, wire_contract::kReplyPartitions> places_;  // last: their callbacks use the rest
};

}  // namespace collided::engine::service
