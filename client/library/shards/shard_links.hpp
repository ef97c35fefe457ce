#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "client/library/connection/connection.hpp"
#include "collided/shards.hpp"
#include "idl/shards/shard_map.hpp"

namespace collided::client {

/// The connections to the shards of a map. Those that are not there are looked for once a second on a thread of this.
///
/// threads  any
class ShardLinks {
 public:
  /// Looks for all shards at once, for at most options.wait. Error no_server where none is there.
  static Result<std::shared_ptr<ShardLinks>> open(shards::ShardMap map, const ConnectOptions& options);
  ~ShardLinks();
  ShardLinks(const ShardLinks&) = delete;
  ShardLinks& operator=(const ShardLinks&) = delete;

  const shards::ShardMap& map() const { return map_; }
  const ConnectOptions& options() const { return options_; }
  /// The connection to a shard; null while it was never there, and while what serves there is not that shard of this map.
  /// One that was lost is kept, since it resumes by itself: calls on it fail with disconnected meanwhile.
  std::shared_ptr<Client> shard(std::size_t place) const;
  /// What that client stands on.
  std::shared_ptr<Connection> connection(std::size_t place) const;
  /// Whether a shard is there and its server was heard a moment ago.
  bool answers(std::size_t place) const;
  /// The epoch of the server that has said that it is the shard. Who answers with another one is to be checked first.
  std::uint64_t epoch(std::size_t place) const;
  /// Asks the server behind a connection whether it is the shard. False: it is not, or does not answer.
  bool check(std::size_t place);
  /// Why a shard is not there; empty: it is, or it was not looked for yet.
  std::string fault(std::size_t place) const;

 private:
  ShardLinks(shards::ShardMap map, const ConnectOptions& options);
  struct ShardLink {
    std::shared_ptr<Client> client;          // null: never found
    std::shared_ptr<Connection> connection;  // likewise
    std::uint64_t epoch = 0;                 // of the server that is the shard; 0: none has said so
    std::string fault;
  };
  void look_for(std::size_t place, std::chrono::nanoseconds wait);
  void look_again(std::size_t place);
  void run();

  const shards::ShardMap map_;
  const ConnectOptions options_;
  mutable std::mutex mutex_;  // for the next two
  std::vector<ShardLink> links_;
  bool is_over_ = false;
  std::condition_variable over_;
  std::thread thread_;
};

}  // namespace collided::client
