#include "server/fleet/fleet_options.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <string_view>

#include "idl/shards/shard_map.hpp"
#include "idl/shards/shard_map_source.hpp"
#include "idl/shards/shard_map_store.hpp"
#include "idl/topics.hpp"
#include "server/service/options/quantities.hpp"
#include "server/service/runtime/place.hpp"

namespace collided::engine::service {
namespace {

using Allowed = std::optional<std::string>;

Allowed apply_standby_of(FleetOptions& fleet, Options& options, const std::string& value) {
  if (value.empty()) return std::nullopt;
  if (!is_namespace(value)) return kNamespaces;
  fleet.standby_of = options.name_space = value;
  return std::nullopt;
}

Allowed apply_join(FleetOptions& fleet, Options& options, const std::string& value) {
  if (value.empty()) return std::nullopt;
  if (!fleet.standby_of.empty()) return "not beside --standby-of";
  if (!is_namespace(value)) return kNamespaces;
  fleet.joins = true;
  options.name_space = value;
  return std::nullopt;
}

Allowed apply_replica_of(FleetOptions& fleet, Options& options, const std::string& value) {
  if (value.empty()) return std::nullopt;
  if (!fleet.standby_of.empty() || fleet.joins) return "not beside --standby-of or --join";
  if (!is_namespace(value)) return kNamespaces;
  fleet.replica_of = options.name_space = value;
  return std::nullopt;
}

void take_shard(FleetOptions& fleet, Options& options, const shards::ShardMap& map, std::size_t place) {
  const shards::ShardBox& held = map.held_by(place);
  options.shard = {.name = map.at(place).name, .held = {.low = Vec3(held.low.data()), .high = Vec3(held.high.data())}};
  fleet.shard_map = map.fingerprint();
}

/// The shard of that name in a map's file.
Allowed take_shard_of_file(FleetOptions& fleet, Options& options, const std::string& path, const std::string& name) {
  try {
    const shards::ShardMap map = shards::ShardMap::read(path);
    const std::optional<std::size_t> place = map.find(name);
    if (!place) return "FILE:NAME with a shard of the map; it has no such one";
    take_shard(fleet, options, map, *place);
  } catch (const shards::ShardMapError& wrong) {
    return std::string("FILE:NAME with a map that can be used; ") + wrong.what();
  }
  return std::nullopt;
}

/// Comes before the addresses that it is for.
Allowed apply_etcd_keys(FleetOptions& fleet, Options&, const std::string& value) {
  if (!value.empty() && !std::filesystem::is_directory(value))
    return "a folder with ca.crt, tls.crt and tls.key, username and password";
  fleet.etcd_keys = value;
  return std::nullopt;
}

/// Comes after those above, whose namespace is then that of the shard.
Allowed apply_shard(FleetOptions& fleet, Options& options, const std::string& value) {
  fleet.shard_map_address.clear();
  if (value.empty()) return std::nullopt;
  if (!fleet.replica_of.empty()) return "not beside --replica-of";
  const std::size_t colon = value.rfind(':');
  if (colon == std::string::npos) return "FILE:NAME, a shard map and the name of one of its shards";
  const std::string source = value.substr(0, colon);
  const std::string name = value.substr(colon + 1);
  if (shards::is_in_etcd(source)) {
    const std::optional<etcd::EtcdAddress> address = etcd::parse_etcd_address(source);
    if (!address || address->key.empty()) return "etcd://HOST:PORT,.../KEY:NAME, with the key of a shard map";
    fleet.shard_map_address = source;
    options.shard = {.name = name, .held = {}};
  } else if (Allowed wrong = take_shard_of_file(fleet, options, source, name)) {
    return wrong;
  }
  options.name_space = shards::shard_namespace(options.name_space, name);
  if (!is_namespace(options.name_space)) return "a shard whose namespace, NAMESPACE/shard_NAME, has at most 64 letters";
  if (!fleet.standby_of.empty()) fleet.standby_of = options.name_space;
  return std::nullopt;
}

Allowed apply_take_over_after(FleetOptions& fleet, Options&, const std::string& value) {
  if (value == "never") {
    fleet.take_over_ns = 0;
    return std::nullopt;
  }
  const std::optional<std::int64_t> silence = parse_duration_ns(value);
  if (!silence || *silence < wire_contract::kTakeOverNs || *silence > 60'000'000'000)
    return "'never' or a time from 200ms to 60s";
  fleet.take_over_ns = *silence;
  return std::nullopt;
}

Allowed apply_authority(FleetOptions& fleet, Options&, const std::string& value) {
  fleet.authority.reset();
  if (value.empty()) return std::nullopt;
  fleet.authority = etcd::parse_etcd_address(value, fleet.etcd_keys);
  if (fleet.authority) return std::nullopt;
  return "etcd://HOST:PORT or etcds://HOST:PORT, up to 16 of them as HOST:PORT,HOST:PORT, then /KEY or nothing";
}

Allowed apply_authority_mode(FleetOptions& fleet, Options&, const std::string& value) {
  if (value != "strict" && value != "fast") return "'strict' or 'fast'";
  fleet.authority_mode = value == "fast" ? TakeOverMode::fast : TakeOverMode::strict;
  return std::nullopt;
}

Allowed apply_authority_lease(FleetOptions& fleet, Options&, const std::string& value) {
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  const std::optional<std::int64_t> life = parse_duration_ns(value);
  const bool is_good = life && *life >= 2 * kSecondNs && *life <= 60 * kSecondNs && *life % kSecondNs == 0;
  if (!is_good) return "whole seconds from 2s to 60s";
  fleet.authority_lease_s = static_cast<int>(*life / kSecondNs);
  return std::nullopt;
}

Allowed apply_member(FleetOptions& fleet, Options&, const std::string& value) {
  constexpr std::size_t kMostLetters = 64;
  if (!value.empty() && (value.size() > kMostLetters || !is_network_word(value)))
    return "1 to 64 letters, digits and '.', '_', '-'";
  fleet.member = value;
  return std::nullopt;
}

struct FleetSetting {
  std::string_view key;  // as in settings()
  Allowed (*apply)(FleetOptions&, Options&, const std::string&);
};

constexpr FleetSetting kFleetSettings[] = {
    {"server.standby_of", apply_standby_of},
    {"server.join", apply_join},
    {"server.replica_of", apply_replica_of},
    {"server.etcd_keys", apply_etcd_keys},
    {"server.shard", apply_shard},
    {"server.take_over_after", apply_take_over_after},
    {"server.authority", apply_authority},
    {"server.authority_mode", apply_authority_mode},
    {"server.authority_lease", apply_authority_lease},
    {"server.member", apply_member},
};

}  // namespace

std::optional<std::string> apply_fleet_setting(FleetOptions& fleet, Options& options, const Setting& setting,
                                               std::span<const std::string> values) {
  const auto found = std::ranges::find(kFleetSettings, std::string_view(setting.key), &FleetSetting::key);
  assert(found != std::end(kFleetSettings) && "a setting of the fleet has no place in it");
  return found->apply(fleet, options, values[0]);
}

void find_shard(FleetOptions& fleet, Options& options) {
  // As long as a server waits for its authority: an election of etcd's members takes one or two.
  constexpr std::chrono::seconds kPatience{6};
  if (fleet.shard_map_address.empty()) return;
  const std::string name = options.shard->name;
  try {
    const shards::KeptShardMap kept = shards::read_shard_map_with(
        fleet.shard_map_address, name, {.etcd_keys = fleet.etcd_keys, .patience = kPatience});
    take_shard(fleet, options, kept.map, *kept.map.find(name));
  } catch (const shards::MapStoreAway& away) { throw CannotServeNow(away.what()); }
}

}  // namespace collided::engine::service
