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

/// The reply writer of one partition, shared by all clients with replies there. Made for the first of them, and kept.
class ReplyPlace {
 public:
  /// The writer is made and a reader is matched.
  bool ready() const { return open_.load(std::memory_order_acquire) && listening_.load(); }

 private:
  friend class Client;
  friend class Clients;

  std::optional<dds::Writer<wire::Reply>> writer_;
  std::atomic<bool> opening_{false};            // a thread is making the writer, or has made it
  std::atomic<bool> open_{false};               // the writer is made; never taken back
  std::atomic<bool> listening_{false};          // a reader is matched
  std::atomic<std::int64_t> deaf_since_ns_{0};  // last change of the match, steady clock
};

/// One client, and its asks that wait until a reader is matched for its replies.
class Client {
 public:
  Client(std::uint64_t id, std::uint64_t asker, std::uint64_t participant, ReplyPlace& place, std::int64_t met_ns,
         bool is_departed = false)
      : id_(id), met_ns_(met_ns), asker_(asker), participant_(participant), place_(place), is_departed_(is_departed) {}
  std::uint64_t id() const { return id_; }
  /// False: the reply was not written, since no reader is matched or a reader's queue stayed full. True for a departed
  /// client: its reply is not missed.
  [[nodiscard]] bool write(const wire::Reply& reply);
  /// The newest version of the world that an answer to this client was about. Any thread.
  std::uint64_t reported_version() const { return reported_version_.load(std::memory_order_relaxed); }
  /// Raises reported_version() to `version`, if that is greater. Any thread.
  void note_reported(std::uint64_t version);
  /// Set once this client's answers are not needed: it is forgotten, or call_off_all() was called. Any thread.
  const std::atomic<bool>& called_off() const { return called_off_; }

 private:
  friend class Clients;
  bool ready() const { return place_.ready(); }

  const std::uint64_t id_;
  const std::int64_t met_ns_;
  const std::uint64_t asker_;        // Ask::owner: others may not ask in its name
  const std::uint64_t participant_;  // of DDS: the process
  ReplyPlace& place_;
  const bool is_departed_;
  std::mutex mutex_;
  std::vector<AskPointer> waiting_;
  std::size_t waiting_bytes_ = 0;  // of waiting_; guarded by Clients::mutex_
  std::atomic<std::uint64_t> reported_version_{0};
  std::atomic<bool> called_off_{false};
};

/// Every live client that has asked. A reply written before a reader is matched would be lost, so asks wait for the
/// match. Clients that share a place wait only for its first match; the library therefore repeats its hello until it is
/// answered.
///
/// threads  any but DDS's own, which may call only find_ready(): making a writer inside a listener would deadlock
class Clients {
 public:
  static constexpr std::size_t kMost = 1'000;                              // clients
  static constexpr std::size_t kMostOfOne = 64;                            // of one Ask::owner
  static constexpr std::size_t kMostOfParticipant = 256;                   // of one process
  static constexpr std::size_t kReserved = 128;                            // of kMost, for processes ...
  static constexpr std::size_t kFew = 8;                                   // ... with fewer clients than this
  static constexpr std::size_t kMostWaiting = 256;                         // asks of one client
  static constexpr std::size_t kMostBytesOfOne = std::size_t{8} << 20;     // of waiting asks, of one Ask::owner
  static constexpr std::size_t kMostWaitingBytes = std::size_t{64} << 20;  // of all
  static constexpr std::int64_t kMatchPatienceNs = 1'000'000'000;  // an ask that waits longer for a match is given up
  static constexpr std::int64_t kDeafPatienceNs = 10'000'000'000;  // without a reader for this long it is forgotten

  /// listening  called with a place when its clients' asks may go on, also on DDS's thread: have a worker call resume()
  Clients(const dds::Topic<wire::Reply>& topic, std::function<void(std::uint32_t)> listening)
      : topic_(topic), listening_(std::move(listening)) {}

  /// The client of an ask, made when it is first seen, with the writer of its place. Null if there are too many clients
  /// in all, of this asker or of its process, or if the number belongs to another live asker.
  std::shared_ptr<Client> meet(std::uint64_t id, std::uint64_t asker, std::uint64_t participant);
  /// Asks that were refused because there are too many clients. Any thread.
  std::uint64_t turned_away() const { return turned_away_.load(std::memory_order_relaxed); }
  /// Null if the client is not known.
  std::shared_ptr<Client> find(std::uint64_t id) const;
  /// The client of an ask if its replies can be written at once, else null. Only for the listener of questions.
  ///
  /// lock  none for a client that asked before and shares its place in recent_ with no other
  Client* find_ready(std::uint64_t id, std::uint64_t asker);
  /// A client that is already forgotten, for writing to where its replies went.
  std::shared_ptr<Client> departed(std::uint64_t id);
  /// Takes the ask and returns true if it must wait for a match. If it does not fit, `ask` becomes the one to drop: the
  /// client's oldest beyond kMostWaiting, else this one.
  bool hold(Client& client, AskPointer& ask);
  /// The asks that waited in this place, for which a reader is matched now.
  std::vector<AskPointer> resume(std::uint32_t place);
  /// Forgets clients whose owner is gone or that have had no reader for kDeafPatienceNs; returns asks that waited
  /// longer than kMatchPatienceNs.
  ///
  /// owners  those connected now
  std::vector<AskPointer> forget_gone(std::span<const std::uint64_t> owners, std::int64_t now_ns);
  /// Ends the questions under way, of all clients.
  void call_off_all();
  std::size_t size() const;

 private:
  static constexpr std::size_t kRecent = 16;

  void open(std::uint32_t place);
  bool has_place_for(std::uint64_t asker, std::uint64_t participant) const;
  bool has_room_for(std::size_t more_bytes, std::uint64_t asker) const;

  const dds::Topic<wire::Reply>& topic_;
  std::function<void(std::uint32_t)> listening_;
  mutable std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<Client>> clients_;
  std::atomic<std::uint64_t> turned_away_{0};
  std::atomic<std::uint64_t> departures_{0};             // clients forgotten: recent_ may hold one of them
  std::array<std::shared_ptr<Client>, kRecent> recent_;  // of the listener's thread alone, by client modulo kRecent
  std::uint64_t recent_departures_ = 0;                  // departures_ when recent_ was filled
  std::array<ReplyPlace, wire_contract::kReplyPartitions> places_;  // last member: its callbacks use the others
};

}  // namespace collided::engine::service
