#pragma once

#include <string>

#include "collided/client.hpp"
#include "idl/shards/shard_map_store.hpp"

namespace collided::client {

/// Why a map cannot be used, or was not to be had.
Error map_error(const shards::ShardMapError& wrong);
Error map_error(const shards::MapStoreAway& away);

shards::MapAccess map_access(const ConnectOptions& options);

/// The map of a source, a file or an address in etcd.
///
/// options  whose `wait` is how long an etcd that does not answer is asked again
/// errors   bad_input for a map that cannot be used, or is not there; no_server where etcd does not answer
Result<shards::KeptShardMap> read_map(const std::string& source, const ConnectOptions& options);

}  // namespace collided::client
