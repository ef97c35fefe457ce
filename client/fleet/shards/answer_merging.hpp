#pragma once

#include <cstddef>
#include <span>

#include "collided/questions.hpp"
#include "idl/shards/shard_map.hpp"

namespace collided::client {

/// What one of the shards that a question touches said to it.
struct ShardAnswer {
  std::size_t place = 0;           // of the shard in the map
  const Answer* answer = nullptr;  // null: it did not answer
};

/// One answer of those of several shards: what a single server that held everything would say.
///
/// Exact, since a shard holds all that comes into its box and the margin around it. The first thing that a ray meets, or
/// the nearest of a point, is met at a point in some shard's box; that shard holds whatever could come before it, and its
/// own exact comparison decides. So of two hits of a ray whose bounds overlap that counts whose point is in the box of the
/// shard that tells it; where two such are of different objects, the shards were asked about different instants, and the
/// answer is undecided (numeric). Near, spheres, boxes and inside come in the order of the doubles, as on one server.
///
/// Of a part in tiles each shard may hold other triangles, and of its triangles it tells what is true of them. So of what
/// several tell of one object that counts which is first, or deepest; of lists of hits, all together.
///
/// A shard says `not_covered` of all that leaves its box and margin; that is left aside, since the other shards answer for
/// it. What a shard that did not answer could change is undecided with not_covered. A doubt of a shard whose box begins
/// beyond the decided hit changes nothing; that of an object whose place is not known counts wherever it may be, so an
/// answer may be undecided that would be decided on one server.
///
/// given    of every shard of touched_shards(), one each; of near those that the nearest found leave
/// threads  pure
Answer merged(const RayQuestion& ray, const shards::ShardMap& map, const AskOptions& options,
              std::span<const ShardAnswer> given);
Answer merged(const SphereQuestion& sphere, const shards::ShardMap& map, const AskOptions& options,
              std::span<const ShardAnswer> given);
Answer merged(const BoxQuestion& box, const shards::ShardMap& map, const AskOptions& options,
              std::span<const ShardAnswer> given);
Answer merged(const NearQuestion& near, const shards::ShardMap& map, const AskOptions& options,
              std::span<const ShardAnswer> given);
Answer merged(const InsideQuestion& inside, const shards::ShardMap& map, const AskOptions& options,
              std::span<const ShardAnswer> given);

/// The shards that may have something as near as what the first one found, or nearer.
shards::ShardSet shards_left(const NearQuestion& near, const shards::ShardMap& map, const AskOptions& options,
                             const Answer& found);

}  // namespace collided::client
