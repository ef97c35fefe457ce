#include "idl/shards/shard_map_source.hpp"

#include <optional>
#include <utility>

namespace collided::shards {

bool is_in_etcd(std::string_view source) { return source.starts_with("etcd://"); }

KeptShardMap read_shard_map(const std::string& source, std::chrono::nanoseconds patience) {
  if (!is_in_etcd(source)) return {.map = ShardMap::read(source)};
  std::optional<KeptShardMap> kept = ShardMapStore(source, patience).read();
  if (!kept) throw ShardMapError(source + ": etcd has no such key");
  return std::move(*kept);
}

KeptShardMap read_shard_map_with(const std::string& address, const std::string& shard,
                                 std::chrono::nanoseconds patience) {
  ShardMapStore store(address, patience);
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
