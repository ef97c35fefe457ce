#include "client/fleet/shards/map_reading.hpp"

#include "client/library/connection/errors.hpp"
#include "idl/shards/shard_map_source.hpp"

namespace collided::client {

Error map_error(const shards::ShardMapError& wrong) { return bad_input(wrong.what()); }

Error map_error(const shards::MapStoreAway& away) {
  return {ErrorCode::no_server, away.what(), "a file with the map will do, too"};
}

shards::MapAccess map_access(const ConnectOptions& options) {
  return {.etcd_keys = options.etcd_keys, .patience = options.wait};
}

Result<shards::KeptShardMap> read_map(const std::string& source, const ConnectOptions& options) {
  try {
    return shards::read_shard_map(source, map_access(options));
  } catch (const shards::MapStoreAway& away) { return map_error(away); } catch (const shards::ShardMapError& wrong) {
    return map_error(wrong);
  }
}

}  // namespace collided::client
