#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "idl/shards/shard_map.hpp"
#include "idl/shards/shard_map_store.hpp"

/// Shard maps in files and in etcd.
namespace collided::cli {

/// The map of a file or an address. Throws Failure: bad_use for one that cannot be used, no_server where etcd does not answer
/// for as long as `patience`.
shards::KeptShardMap take_map(const std::string& source, std::chrono::nanoseconds patience);

/// The revision of what is under a key of etcd, 0 where there is none. Throws Failure.
std::int64_t revision_at(const std::string& address, std::chrono::nanoseconds patience);

/// Writes a map to a file, or to a key of etcd, there only in the place of that revision; 0: there must be none. Returns the
/// revision of what is there then, 0 of a file. Throws Failure: refused where another map is there.
std::int64_t write_map(const shards::ShardMap& map, const std::string& target, std::int64_t in_place_of,
                       std::chrono::nanoseconds patience);

}  // namespace collided::cli
