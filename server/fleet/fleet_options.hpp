#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "idl/etcd/etcd_address.hpp"
#include "server/fleet/authority/leadership.hpp"
#include "server/service/options/options.hpp"

namespace collided::engine::service {

/// What a server is among others, each value checked. Keys, flags, variables and defaults: settings().
struct FleetOptions {
  std::string standby_of;         // namespace of the primary that this server stands by for; empty: none
  std::string replica_of;         // namespace of the primary beside which this server answers questions; empty: none
  bool joins = false;             // it stands by where a primary is there, else it is the primary
  std::int64_t take_over_ns = 0;  // of a standby: a primary that is silent for so long is replaced; 0: never
  std::string etcd_keys;          // folder for etcds://; empty: none
  std::string shard_map_address;  // the shard's map is in etcd: until find_shard() only the shard's name is known
  std::uint64_t shard_map = 0;    // of a shard: the map's fingerprint
  std::optional<etcd::EtcdAddress> authority{};  // that says who is the primary; none: each server for itself
  TakeOverMode authority_mode = TakeOverMode::strict;
  int authority_lease_s = 0;
  std::string member;  // what it is called among the servers of its namespace; empty: by machine and process
};

/// Checks and stores the value of a setting of the fleet, as Setting::apply does; some change the server's namespace and
/// what it holds of the world.
std::optional<std::string> apply_fleet_setting(FleetOptions& fleet, Options& options, const Setting& setting,
                                               std::span<const std::string> values);

/// Looks in etcd which box the shard has, if its map is there. Waits for etcd for some seconds.
///
/// throws  CannotServeNow where etcd does not answer; shards::ShardMapError for a map that cannot be used, or has no such
///         shard
void find_shard(FleetOptions& fleet, Options& options);

}  // namespace collided::engine::service
