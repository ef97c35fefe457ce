#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/fleet/shards/shard_links.hpp"
#include "collided/shards.hpp"

namespace collided::client {

/// How two objects of a world on several shards stand to each other: what a shard that holds both says. Two that no shard
/// holds are farther apart than the margin, since at each point of one there is a shard that holds all that is nearer.
///
/// threads  any
Result<ShardedPairAnswer> pair_of_shards(ShardLinks& links, const std::string& a, const std::string& b,
                                         const PairOptions& options);

/// The nearest pairs of two groups, of all pairs that are no farther apart than the margin: each of them some shard holds.
///
/// options  `to` must be named
/// threads  any
Result<ShardedClearanceAnswer> clearance_of_shards(ShardLinks& links, const std::string& from,
                                                   const ClearanceOptions& options);

/// Whether a shard has an object of that name; nothing: it does not answer that. A refusal can have other reasons.
std::optional<bool> has_object(Client& shard, const std::string& name);

/// A lower bound of the number of a shard's objects in a group: an object, a scene or a glob; nothing: it does not answer that.
std::optional<std::uint64_t> count_of_group(Client& shard, const std::string& group);

}  // namespace collided::client
