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

#include "client/library/connection/route.hpp"
#include "idl/dds.hpp"

namespace collided::client {

/// The replicas of a connection's server. The next question goes to the server with the fewest of this client's questions;
/// of several with as few, to one on this machine, and in turn. The primary is asked what a replica refuses or does not
/// answer. Until DDS shows that other servers are there, this costs nothing: no thread, no topic.
class Replicas : public Route {
  struct ReplicaPlace;

  /// The server that is asked. It counts as busy for as long as this is kept.
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

 public:
  explicit Replicas(Connection& primary);
  ~Replicas() override;

  void note_company() override { has_company_.store(true, std::memory_order_relaxed); }
  bool has_company() const override { return has_company_.load(std::memory_order_relaxed); }

  /// The error is that of the primary, or of a replica where the primary is silent. A settled state that another server has
  /// passed already is waited for, half of the question's timeout at most.
  std::optional<Error> ask(const AskOnce& once, const AskOptions& options, const Answers& answers,
                           Clock::time_point deadline) override;

  /// Replicas are asked again once each was found to hold the primary's world at a later instant.
  void note_change(std::int64_t world_time_ns) override;
  void note_possible_change() override;

 private:
  /// The server to be asked.
  /// as_primary  the primary, unless that is silent and a replica is not
  AskedServer next(bool as_primary);
  void note_settled(std::int64_t world_time_ns);

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
  std::atomic<std::int64_t> settled_ns_{0};        // world time of the newest settled state that an answer was about
  std::mutex mutex_;                               // for the next five
  const std::shared_ptr<ReplicaPlace> own_place_;  // of the primary
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
