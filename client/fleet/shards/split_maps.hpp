#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "collided/client.hpp"
#include "idl/shards/shard_map_store.hpp"

namespace collided::client {

/// The two maps of a split. Where the first one is in etcd, the next one takes its place there before the servers are told
/// that it holds: by a compare-and-swap with the revision that was read, so that of two who split one map one goes on.
///
/// threads  one
class SplitMaps {
 public:
  /// next_source  empty: what is to succeed the map in etcd, KEY/next
  /// errors       as read_map()
  static Result<SplitMaps> read(const std::string& source, const std::string& next_source,
                                const ConnectOptions& options);

  const shards::ShardMap& map() const { return now_.map; }
  const shards::ShardMap& next() const { return next_.map; }
  /// Whether the next map is in the first one's place in etcd: then the split can only go on.
  bool is_swapped() const { return is_swapped_; }

  /// Puts the next map in the first one's place, where it is in etcd and not there yet. Error refused: somebody has put
  /// another one there; no_server: it may be there, and may not.
  std::optional<Error> swap();
  /// Has nobody who has read the first map before put another one in its place any more. Errors as swap().
  std::optional<Error> keep();

 private:
  SplitMaps(std::string source, shards::KeptShardMap now, shards::KeptShardMap next)
      : source_(std::move(source)), now_(std::move(now)), next_(std::move(next)) {}
  template <class Write>
  std::optional<Error> change(const Write& write);

  std::string source_;
  shards::KeptShardMap now_;
  shards::KeptShardMap next_;
  std::unique_ptr<shards::ShardMapStore> store_;  // null: the maps are files
  bool is_swapped_ = false;
};

}  // namespace collided::client
