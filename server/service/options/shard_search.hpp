#pragma once

#include "server/service/options/options.hpp"

namespace collided::engine::service {

/// Looks in etcd which box the shard has, where that is where its map is; else it does nothing.
///
/// throws  shards::MapStoreAway where etcd has not answered for some seconds; shards::ShardMapError for a map that cannot be
///         used, or has no such shard
void find_shard(Options& options);

}  // namespace collided::engine::service
