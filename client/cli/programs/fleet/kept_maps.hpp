#pragma once

#include <cstdint>
#include <string>

#include "client/cli/session.hpp"
#include "idl/shards/shard_map.hpp"
#include "idl/shards/shard_map_store.hpp"

/// Shard maps in files and in etcd.
namespace collided::cli {

/// The access to etcd that the command's options choose.
shards::MapAccess map_access(const Io& io, const Globals& globals);

/// The map of a file or an address. Throws Failure: bad_use for one that cannot be used, no_server if etcd does not answer in
/// time.
shards::KeptShardMap take_map(const std::string& source, const shards::MapAccess& access);

/// The revision of the value under a key of etcd, 0 if there is none. Throws Failure.
std::int64_t revision_at(const std::string& address, const shards::MapAccess& access);

/// Writes a map to a file, or to a key of etcd, where it must replace that revision; 0: the key must not exist. Returns
/// the resulting revision, 0 for a file. Throws Failure: refused if another map is there.
std::int64_t write_map(const shards::ShardMap& map, const std::string& target, std::int64_t in_place_of,
                       const shards::MapAccess& access);

}  // namespace collided::cli
