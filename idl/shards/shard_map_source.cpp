#include "idl/shards/shard_map_source.hpp"

#include <optional>
#include <utility>

namespace collided::shards {

KeptShardMap read_shard_map(const std::string& source, const MapAccess& access) {
  if (!is_in_etcd(source)) return {.map = ShardMap::read(source)};
  std::optional<KeptShardMap> kept = ShardMapStore(source, access).read();
  if (!kept) throw ShardMapError(source + ": etcd has no such key");
  return std::move(*kept);
}

KeptShardMap read_shard_map_with(const std::string& address, const std::string& shard, const MapAccess& access) {
  ShardMapStore store(address, access);
  std::optional<KeptShardMap> current = store.read();
  if (!current) throw ShardMapError(address + ": etcd has no such key");
  if (current->map.find(shard)) return std::move(*current);
  for (const ShardMapStore::Which which : {ShardMapStore::Which::next, ShardMapStore::Which::before}) {
    std::optional<KeptShardMap> other = store.read(which);
    if (other && other->map.find(shard)) return std::move(*other);
  }
  throw ShardMapError(address + ": revision " + std::to_string(current->revision) + " has no shard '" + shard +
                      "', nor has the map before it or the next one");
}

}  // namespace collided::shards
