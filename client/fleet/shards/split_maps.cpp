#include "client/fleet/shards/split_maps.hpp"

#include <utility>

#include "client/library/connection/errors.hpp"
#include "client/fleet/shards/map_reading.hpp"
#include "idl/shards/shard_map_source.hpp"

namespace collided::client {

using shards::KeptShardMap;
using shards::MapStoreAway;
using shards::ShardMapError;
using shards::ShardMapStore;

namespace {

KeptShardMap next_of(ShardMapStore& store, const std::string& source) {
  std::optional<KeptShardMap> next = store.read(ShardMapStore::Which::next);
  if (!next) throw ShardMapError(source + "/next: etcd has no such key, and no other next map was named");
  return std::move(*next);
}

KeptShardMap before_of(ShardMapStore& store, const std::string& source) {
  std::optional<KeptShardMap> before = store.read(ShardMapStore::Which::before);
  if (!before)
    throw ShardMapError(source + ": the next map is there already, and KEY/before, which it succeeds, is not");
  return std::move(*before);
}

}  // namespace

Result<SplitMaps> SplitMaps::read(const std::string& source, const std::string& next_source,
                                  const ConnectOptions& options) {
  try {
    KeptShardMap now = shards::read_shard_map(source, map_access(options));
    const bool is_in_etcd = shards::is_in_etcd(source);
    if (!is_in_etcd && next_source.empty()) return bad_input("a map in a file needs another one that comes next");
    std::unique_ptr<ShardMapStore> store;
    if (is_in_etcd) store = std::make_unique<ShardMapStore>(source, map_access(options));
    KeptShardMap next =
        next_source.empty() ? next_of(*store, source) : shards::read_shard_map(next_source, map_access(options));
    const bool is_swapped = is_in_etcd && now.map.fingerprint() == next.map.fingerprint();
    if (is_swapped) now = before_of(*store, source);
    SplitMaps maps(source, std::move(now), std::move(next));
    maps.store_ = std::move(store);
    maps.is_swapped_ = is_swapped;
    return maps;
  } catch (const MapStoreAway& away) { return map_error(away); } catch (const ShardMapError& wrong) {
    return map_error(wrong);
  }
}

template <class Write>
std::optional<Error> SplitMaps::change(const Write& write) {
  if (!store_ || is_swapped_) return std::nullopt;
  try {
    if (const std::optional<std::int64_t> revision = write(*store_)) {
      now_.revision = *revision;
      return std::nullopt;
    }
    return Error{ErrorCode::refused,
                 source_ + ": revision " + std::to_string(now_.revision) +
                     " was read, and somebody has put another map there since",
                 "look what is there: collide fleet --shards " + source_};
  } catch (const MapStoreAway& away) { return map_error(away); }
}

std::optional<Error> SplitMaps::swap() {
  auto failed = change([&](ShardMapStore& store) { return store.succeed(now_, next_.map); });
  if (!failed) is_swapped_ = store_ != nullptr;
  return failed;
}

std::optional<Error> SplitMaps::keep() {
  return change([&](ShardMapStore& store) { return store.write(now_.map, now_.revision); });
}

}  // namespace collided::client
