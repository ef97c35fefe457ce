#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "client/library/connection/connection.hpp"
#include "collided/shards.hpp"
#include "idl/shards/shard_map.hpp"
#include "idl/shards/shard_split.hpp"

namespace collided::client {

/// A shard that falls silent may have a standby, which takes its place within this time, where the shard says no other one.
inline constexpr std::chrono::nanoseconds kUsuallyReplaced = std::chrono::seconds(1);

/// Which shards there are now. Places are the same in both maps and in every later view: of shards that have gone they stay
/// empty, and new ones come behind.
struct ShardView {
  shards::ShardMap asked;  // whose shards answer questions
  shards::ShardMap held;  // whose shards are told of objects and watched: while one is split, it and those in its place
  std::uint64_t held_by;  // fingerprint of the newest map whose shards are all in `held`
};

/// The connections to the shards of a map, and of those that succeed it. Those that are not there are looked for once a
/// second on a thread of this; one shard a second is asked whether one is split.
///
/// threads  any
class ShardLinks {
 public:
  /// Looks for all shards at once, for at most options.wait. Error no_server where none is there.
  static Result<std::shared_ptr<ShardLinks>> open(shards::ShardMap map, const ConnectOptions& options);
  ~ShardLinks();
  ShardLinks(const ShardLinks&) = delete;
  ShardLinks& operator=(const ShardLinks&) = delete;

  std::shared_ptr<const ShardView> view() const;
  const ConnectOptions& options() const { return options_; }
  /// The connection to a shard; null while it was never there, and while what serves there is not that shard of this map.
  /// One that was lost is kept, since it resumes by itself: calls on it fail with disconnected meanwhile.
  std::shared_ptr<Client> shard(std::size_t place) const;
  /// What that client stands on.
  std::shared_ptr<Connection> connection(std::size_t place) const;
  /// Whether a shard is there and its server was heard a moment ago.
  bool answers(std::size_t place) const;
  /// Whether it answers, or fell silent only so short a while ago that a standby may be taking its place.
  bool may_answer(std::size_t place) const;
  /// How long after it fell silent a standby may still take its place, as the shard has said.
  std::chrono::nanoseconds replaced_within(std::size_t place) const;
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
    std::chrono::nanoseconds replaced_within = kUsuallyReplaced;
    std::string fault;
  };
  bool is_one_there(Clock::time_point deadline);
  void look_for(std::size_t place, std::chrono::nanoseconds wait);
  void look_again(std::size_t place);
  void ask_for_news();
  void learn(const shards::MapSuccession& said);
  void show(const shards::MapSuccession& said);
  std::string fault_of(const shards::MapSuccession& said) const;
  bool is_changing() const;
  void run();

  const ConnectOptions options_;
  mutable std::mutex mutex_;  // for what follows
  std::shared_ptr<const ShardView> view_;
  std::map<std::uint64_t, shards::ShardSet> known_;  // the shards of each map, by its fingerprint
  std::uint64_t own_map_ = 0;                        // fingerprint of the one that this was opened with
  std::optional<shards::MapSuccession> newest_;      // by its revision
  std::vector<ShardLink> links_;                     // by place in the view
  std::size_t asked_last_ = 0;                       // for news
  bool is_over_ = false;
  std::condition_variable over_;
  std::thread thread_;
};

}  // namespace collided::client
