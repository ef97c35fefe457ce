#include "server/service/options/shard_search.hpp"

#include <chrono>

#include "idl/shards/shard_map_source.hpp"

namespace collided::engine::service {

void find_shard(Options& options) {
  // As long as a server waits for its authority: an election of etcd's members takes one or two.
  constexpr std::chrono::seconds kPatience{6};
  if (options.shard_map_address.empty()) return;
  const std::string& name = options.shard->name;
  const shards::KeptShardMap kept = shards::read_shard_map_with(options.shard_map_address, name, kPatience);
  options.shard = shard_place(kept.map, *kept.map.find(name));
}

}  // namespace collided::engine::service
