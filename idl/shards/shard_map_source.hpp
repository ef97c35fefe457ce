#pragma once

#include <cstdint>
#include <string>

#include "idl/etcd/etcd_address.hpp"
#include "idl/shards/shard_map.hpp"
#include "idl/shards/shard_map_store.hpp"

/// Where a shard map is: in a file, or in etcd.
namespace collided::shards {

using etcd::is_in_etcd;

/// The map of a source; of a file with revision 0.
///
/// source  a file, or etcd://HOST:PORT[,HOST:PORT...]/KEY
/// throws  ShardMapError, which begins with the source, also where nothing is there; MapStoreAway
KeptShardMap read_shard_map(const std::string& source, const MapAccess& access);

/// The map in etcd that has a shard of that name: the one that holds, else the one that is to succeed it, since a split's new
/// servers start before it holds, else the one before it, so that the server of a shard that was split may be started again
/// while others still ask it.
///
/// throws  as read_shard_map(); ShardMapError where none of them has it
KeptShardMap read_shard_map_with(const std::string& address, const std::string& shard, const MapAccess& access);

}  // namespace collided::shards
