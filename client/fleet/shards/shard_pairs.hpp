#pragma once

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

}  // namespace collided::client
