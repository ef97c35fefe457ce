#pragma once

#include <span>

#include "client/fleet/shards/shard_links.hpp"

namespace collided::client {

/// Asks questions of all shards that they touch, each shard once with all of its own, and merges the answers; see
/// answer_merging.hpp. Of near first the shard that owns the point, then those that may have something nearer.
///
/// A shard that is silent, or that another one has taken the place of, has not answered. What a shard refuses is refused
/// as a whole.
///
/// threads  any
template <class Question>
Result<Answers> ask_shards(ShardLinks& links, std::span<const Question> questions, const AskOptions& options);

}  // namespace collided::client
