#include "client/cli/programs/fleet/kept_maps.hpp"

#include <fstream>
#include <optional>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "idl/shards/shard_map_source.hpp"

namespace collided::cli {
namespace {

using shards::KeptShardMap;
using shards::ShardMap;
using shards::ShardMapStore;

/// The result of call(); an error of etcd or of a map becomes a Failure.
template <class Call>
auto or_failure(const Call& call) {
  try {
    return call();
  } catch (const shards::MapStoreAway& away) {
    throw Failure(Exit::no_server, away.what());
  } catch (const shards::ShardMapError& wrong) { throw bad_use(wrong.what()); }
}

void write_file(const ShardMap& map, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << map.text();
  file.close();
  if (!file) throw Failure(Exit::bad_use, fmt::format("{} cannot be written", path));
}

}  // namespace

shards::MapAccess map_access(const Io& io, const Globals& globals) {
  const ConnectOptions options = connect_options(io, globals);
  return {.etcd_keys = options.etcd_keys, .patience = options.wait};
}

KeptShardMap take_map(const std::string& source, const shards::MapAccess& access) {
  return or_failure([&] { return shards::read_shard_map(source, access); });
}

std::int64_t revision_at(const std::string& address, const shards::MapAccess& access) {
  return or_failure([&] { return ShardMapStore(address, access).revision(); });
}

std::int64_t write_map(const ShardMap& map, const std::string& target, std::int64_t in_place_of,
                       const shards::MapAccess& access) {
  if (!shards::is_in_etcd(target)) {
    write_file(map, target);
    return 0;
  }
  return or_failure([&] {
    ShardMapStore store(target, access);
    if (const std::optional<std::int64_t> revision = store.write(map, in_place_of)) return *revision;
    const std::int64_t there = store.revision();
    if (there == 0) throw Failure(Exit::refused, fmt::format("{}: there is no revision {}", target, in_place_of));
    throw Failure(Exit::refused, fmt::format("{}: another map is there, revision {}", target, there),
                  fmt::format("collide fleet publish ... --revision {} puts this one in its place", there));
  });
}

}  // namespace collided::cli
