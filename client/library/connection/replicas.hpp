#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "client/library/connection/server_pulse.hpp"
#include "idl/dds.hpp"

namespace collided::client {

class Connection;

/// The replicas of a connection's server, and who is asked next: whoever has the fewest of this client's questions; of
/// several with as few one on this machine, and in turn. Until DDS shows that other servers are there, this costs nothing:
/// no thread, no topic.
///
/// threads  any
class Replicas {
  struct ReplicaPlace;

 public:
  /// Who is asked, and counts as busy for as long as this is kept.
  class AskedServer {
   public:
    AskedServer(Replicas& owner, std::shared_ptr<ReplicaPlace> place, std::shared_ptr<Connection> connection)
        : owner_(owner), place_(std::move(place)), connection_(std::move(connection)) {}
    ~AskedServer();
    AskedServer(const AskedServer&) = delete;
    AskedServer& operator=(const AskedServer&) = delete;

    /// Null: the primary is asked.
    Connection* replica() const { return connection_.get(); }

   private:
    Replicas& owner_;
    std::shared_ptr<ReplicaPlace> place_;  // null: nothing is counted, since there are no replicas
    std::shared_ptr<Connection> connection_;
  };

  /// primary  whose replicas these are; it must outlive this
  explicit Replicas(Connection& primary);
  ~Replicas();
  Replicas(const Replicas&) = delete;
  Replicas& operator=(const Replicas&) = delete;

  /// Other servers write the namespace's status: from the next question on replicas are looked for.
  void note_company() { has_company_.store(true, std::memory_order_relaxed); }
  /// Whether there is anybody but the primary.
  bool has_company() const { return has_company_.load(std::memory_order_relaxed); }

  /// Who is to be asked.
  /// as_primary  the primary, unless that is silent and a replica is not
  AskedServer next(bool as_primary);

  /// A command of this client has changed the world by then, world time. Replicas are asked again once each was found to
  /// hold the primary's world at a later instant.
  void note_change(std::int64_t world_time_ns);
  /// A command failed, and may have been carried out.
  void note_possible_change();

  /// World time of the newest settled state that this client has had an answer about.
  std::int64_t settled_ns() const { return settled_ns_.load(std::memory_order_relaxed); }
  void note_settled(std::int64_t world_time_ns);

 private:
  /// What a server said that its world was at an instant.
  struct SaidWorld {
    std::int64_t time_ns = 0;
    std::uint64_t hash = 0;
  };
  struct ReplicaPlace {
    std::uint64_t server = 0;
    std::shared_ptr<Connection> connection;  // null: not yet made; of the primary: never
    std::deque<SaidWorld> said;              // the newest
    std::int64_t same_at_ns = 0;             // the newest instant at which its world was the primary's
    unsigned asked = 0;                      // requests of this client under way
    bool is_elsewhere = false;               // on another machine
    Clock::time_point heard;
  };

  bool is_usable(const ReplicaPlace& place) const;
  void run();
  void take(dds::Reader<wire::Member>& reader, dds::Sample<wire::Member>& sample);
  void hear(const wire::Member& member);
  void compare(ReplicaPlace& place) const;
  void connect_new();
  void forget_gone();

  Connection& primary_;
  std::atomic<bool> has_company_{false};
  std::atomic<std::int64_t> settled_ns_{0};
  std::mutex mutex_;                                             // for the next five
  const std::shared_ptr<ReplicaPlace> own_place_;                // of the primary
  std::map<std::string, std::shared_ptr<ReplicaPlace>> places_;  // of replicas, by name
  std::int64_t changed_ns_ = 0;                                  // world time
  std::size_t turn_ = 0;
  const std::string host_;
  bool is_looking_ = false;  // the thread was started
  std::atomic<bool> is_over_{false};
  std::unique_ptr<dds::WaitSet> waitset_;
  std::thread thread_;
};

}  // namespace collided::client
