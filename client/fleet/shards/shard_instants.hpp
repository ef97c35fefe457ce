#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "client/fleet/shards/shard_links.hpp"

namespace collided::client {

/// Whether the error says that a shard did not answer; another one is a refusal, or a fault of the question.
bool is_silence(const Error& error);

/// As of when each shard of a map is asked, so that all answer about one instant.
///
/// The settled one is the earliest of the shards' settled instants. A shard where nobody publishes has not changed since its
/// own newest state, which therefore is its state at any later instant: it is asked for that state, and its answer counts
/// only where it is still the newest.
struct ShardInstants {
  struct OfShard {
    Instant instant;
    std::optional<std::uint64_t> version;  // of the state that must have answered
    bool is_there = true;                  // false: it did not say where it is
  };
  std::vector<OfShard> of_shard;                 // by the shard's place
  std::optional<std::chrono::nanoseconds> time;  // world time of all; nothing: each shard's newest
};

/// map      whose shards are asked
/// threads  any
/// cost     nothing for `latest`, else a question to every shard
Result<ShardInstants> choose_instants(const ShardLinks& links, const shards::ShardMap& map, const AskOptions& options);

}  // namespace collided::client
