#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "idl/etcd/lease_store.hpp"
#include "idl/shards/shard_map.hpp"

namespace collided::shards {

/// etcd did not answer, so what it keeps is not known: another start may find it.
struct MapStoreAway : ShardMapError {
  using ShardMapError::ShardMapError;
};

/// How etcd is asked.
struct MapAccess {
  std::string etcd_keys;                 // folder, see etcd::EtcdKeys; empty: none
  std::chrono::nanoseconds patience{0};  // so long an etcd that does not answer is asked again
};

/// A map as it stands under a key.
struct KeptShardMap {
  ShardMap map;
  std::int64_t revision = 0;  // of the write that put it there; greater than those of all writes before
};

/// The maps of a world in etcd: the one that holds under KEY, the one that is to succeed it under KEY/next, and the one
/// before it under KEY/before. Each is the JSON text that ShardMap reads. A map is written only in the place of a revision
/// that the writer has seen, so that of two writers one wins.
///
/// throws   each call: MapStoreAway where etcd does not answer for as long as this is patient; ShardMapError, with key and
///          revision, for what is there and no map
/// threads  one
class ShardMapStore {
 public:
  enum class Which : std::uint8_t { current, next, before };

  /// address  etcd://HOST:PORT[,HOST:PORT...]/KEY, or etcds://
  /// throws   ShardMapError: it is no such address
  ShardMapStore(const std::string& address, const MapAccess& access);
  /// address  as messages have it
  ShardMapStore(std::unique_ptr<etcd::LeaseStore> store, std::string key, std::string address,
                std::chrono::nanoseconds patience);

  /// Nothing: there is none.
  std::optional<KeptShardMap> read(Which which = Which::current);
  /// Of what is under KEY, be it a map or not; 0: nothing.
  std::int64_t revision();
  /// Writes KEY where it has that revision; 0: where there is no such key. The revision of what is there then, also where
  /// the same map was there already. Nothing: another one is there, and stays.
  std::optional<std::int64_t> write(const ShardMap& map, std::int64_t in_place_of);
  /// Puts a map in the place of the one that holds, which is KEY/before from then on. As write().
  std::optional<std::int64_t> succeed(const KeptShardMap& now, const ShardMap& next);

 private:
  std::string key_of(Which which) const;
  etcd::StoreResult ask(const etcd::StoreTransaction& transaction);
  std::optional<std::int64_t> change(etcd::StoreTransaction transaction, const ShardMap& map);

  const std::unique_ptr<etcd::LeaseStore> store_;
  const std::string key_;
  const std::string address_;
  const std::chrono::nanoseconds patience_;
};

}  // namespace collided::shards
