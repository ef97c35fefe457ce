#pragma once

#include <cstddef>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "client/fleet/shards/shard_instants.hpp"
#include "client/fleet/shards/shard_links.hpp"
#include "idl/shards/shard_map.hpp"

namespace collided::client {

/// What a shard says that was asked; an error that is_silence() where it said nothing.
template <class Said>
struct ShardSaid {
  std::size_t place = 0;  // in the map
  Result<Said> said;
};

/// Asks all shards of a map the same, at once, about one instant.
///
/// ask      (Client&, const Instant&) -> Result<Said>, on a thread for each; Said has the `version` that answered
/// returns  one for each shard, in the map's order
/// error    the world went on between the choice of the instant and the answers, again and again
/// threads  any
template <class Said, class Ask>
Result<std::vector<ShardSaid<Said>>> ask_every_shard(ShardLinks& links, const shards::ShardMap& map,
                                                     const AskOptions& about, const Ask& ask) {
  const auto ask_one = [&](std::size_t place, const ShardInstants::OfShard& of) -> Result<Said> {
    const Error silent{ErrorCode::disconnected, "shard '" + map.at(place).name + "' does not answer", ""};
    const std::shared_ptr<Client> client = of.is_there ? links.shard(place) : nullptr;
    if (!client) return silent;
    Result<Said> said = ask(*client, of.instant);
    const Result<ServerStatus> status = client->status();
    // Another server is in its place since it was last looked at: it must say who it is.
    if (!status || (status->epoch != links.epoch(place) && !links.check(place))) return silent;
    return said;
  };
  constexpr int kMostTries = 3;
  for (int tries = 0; tries < kMostTries; ++tries) {
    const Result<ShardInstants> instants = choose_instants(links, map, about);
    if (!instants) return instants.error();
    std::vector<std::future<ShardSaid<Said>>> asked;
    shards::for_each_place(map.all(), [&](std::size_t place) {
      const ShardInstants::OfShard& of = instants->of_shard[place];
      asked.push_back(std::async(std::launch::async, [&ask_one, &of, place] {
        return ShardSaid<Said>{.place = place, .said = ask_one(place, of)};
      }));
    });
    std::vector<ShardSaid<Said>> all;
    bool is_outrun = false;
    for (std::future<ShardSaid<Said>>& one : asked) {
      all.push_back(one.get());
      const std::optional<std::uint64_t>& version = instants->of_shard[all.back().place].version;
      const Result<Said>& said = all.back().said;
      is_outrun = is_outrun || (said && version && said->version != *version);
    }
    if (!is_outrun) return all;
  }
  return Error{ErrorCode::timeout, "the shards began to change while they were asked about one instant", "ask again"};
}

}  // namespace collided::client
