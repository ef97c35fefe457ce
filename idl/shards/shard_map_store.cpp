#include "idl/shards/shard_map_store.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include "idl/etcd/etcd_address.hpp"
#include "idl/etcd/etcd_client.hpp"
#include "idl/module.hpp"

namespace collided::shards {
namespace {

using std::chrono::nanoseconds;
using Clock = std::chrono::steady_clock;

/// Between two tries: one that refuses at once may be starting, or electing a leader.
constexpr nanoseconds kTryAgain = std::chrono::milliseconds(100);
constexpr nanoseconds kLongestTry = std::chrono::seconds(1);  // of one member

etcd::EtcdAddress parsed(const std::string& address, const std::string& keys = {}) {
  const std::optional<etcd::EtcdAddress> read = etcd::parse_etcd_address(address, keys);
  if (!read || read->key.empty())
    throw ShardMapError(address +
                        ": the address of a shard map in etcd is etcd://HOST:PORT[,HOST:PORT...]/KEY, or etcds://");
  return *read;
}

std::unique_ptr<etcd::LeaseStore> client_of(const std::string& address, const MapAccess& access) {
  etcd::EtcdAddress read = parsed(address, access.etcd_keys);
  const nanoseconds each = access.patience / static_cast<std::int64_t>(read.endpoints.size());
  try {
    return std::make_unique<etcd::EtcdClient>(std::move(read), std::min(each, kLongestTry).count());
  } catch (const ModuleMissing& missing) { throw ShardMapError(address + ": " + missing.what()); }
}

}  // namespace

ShardMapStore::ShardMapStore(const std::string& address, const MapAccess& access)
    : ShardMapStore(client_of(address, access), parsed(address).key, address, access.patience) {}

ShardMapStore::ShardMapStore(std::unique_ptr<etcd::LeaseStore> store, std::string key, std::string address,
                             nanoseconds patience)
    : store_(std::move(store)), key_(std::move(key)), address_(std::move(address)), patience_(patience) {}

std::string ShardMapStore::key_of(Which which) const {
  switch (which) {
    case Which::current: return key_;
    case Which::next: return key_ + "/next";
    case Which::before: return key_ + "/before";
  }
  return key_;
}

/// May do twice what changes something only where it is the first time.
etcd::StoreResult ShardMapStore::ask(const etcd::StoreTransaction& transaction) {
  const Clock::time_point until = Clock::now() + patience_;
  while (true) {
    try {
      return store_->transact(transaction);
    } catch (const etcd::StoreRefused& refused) {
      throw ShardMapError(address_ + ": " + refused.what() + ". No map was read or written");
    } catch (const etcd::StoreError& failed) {
      if (Clock::now() + kTryAgain > until) throw MapStoreAway(address_ + ": etcd does not answer: " + failed.what());
    }
    std::this_thread::sleep_for(kTryAgain);
  }
}

std::optional<KeptShardMap> ShardMapStore::read(Which which) {
  const etcd::StoreResult found = ask({.conditions = {}, .writes = {}, .reads = {key_of(which)}});
  if (!found.values.at(0)) return std::nullopt;
  const std::int64_t revision = found.revisions.at(0);
  try {
    return KeptShardMap{.map = ShardMap::parse(*found.values[0]), .revision = revision};
  } catch (const ShardMapError& wrong) {
    throw ShardMapError(address_ + ": key '" + key_of(which) + "', revision " + std::to_string(revision) + ": " +
                        wrong.what());
  }
}

std::int64_t ShardMapStore::revision() {
  return ask({.conditions = {}, .writes = {}, .reads = {key_}}).revisions.at(0);
}

std::optional<std::int64_t> ShardMapStore::change(etcd::StoreTransaction transaction, const ShardMap& map) {
  transaction.reads = {key_};
  const etcd::StoreResult result = ask(transaction);
  // A try whose answer was lost may have done it.
  if (result.is_done || result.values.at(0) == map.text()) return result.revisions.at(0);
  return std::nullopt;
}

std::optional<std::int64_t> ShardMapStore::write(const ShardMap& map, std::int64_t in_place_of) {
  etcd::StoreCondition seen{.key = key_};
  if (in_place_of != 0) seen = {.key = key_, .is = etcd::StoreCondition::Is::revision, .revision = in_place_of};
  return change({.conditions = {seen}, .writes = {{key_, map.text()}}, .reads = {}}, map);
}

std::optional<std::int64_t> ShardMapStore::succeed(const KeptShardMap& now, const ShardMap& next) {
  return change({.conditions = {{.key = key_, .is = etcd::StoreCondition::Is::revision, .revision = now.revision}},
                 .writes = {{key_, next.text()}, {key_of(Which::before), now.map.text()}},
                 .reads = {}},
                next);
}

}  // namespace collided::shards
