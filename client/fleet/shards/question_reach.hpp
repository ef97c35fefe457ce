#pragma once

#include <optional>

#include "collided/questions.hpp"
#include "idl/shards/shard_map.hpp"

/// Which shards a question can touch. All bounds are rounded outward: a shard too many costs a request, one too few would
/// lose a hit.
namespace collided::client {

/// The shards that can change the answer.
shards::ShardSet touched_shards(const shards::ShardMap& map, const RayQuestion& ray);
shards::ShardSet touched_shards(const shards::ShardMap& map, const SphereQuestion& sphere);
shards::ShardSet touched_shards(const shards::ShardMap& map, const BoxQuestion& box);
shards::ShardSet touched_shards(const shards::ShardMap& map, const NearQuestion& near);
/// The owner of the point: a solid that holds it is in that shard.
shards::ShardSet touched_shards(const shards::ShardMap& map, const InsideQuestion& inside);

/// How far along the ray it enters the box, at least; nothing where it surely passes it. Metres.
std::optional<double> entry_m(const shards::ShardBox& box, const RayQuestion& ray);
/// How far the box is from the point, at least.
double entry_m(const shards::ShardBox& box, const NearQuestion& near);

/// Where a question enters a box that it touches: on a ray, else the point of the box next to its beginning.
Vec3 entry_point(const shards::ShardBox& box, const RayQuestion& ray);
Vec3 entry_point(const shards::ShardBox& box, const Vec3& beginning);

}  // namespace collided::client
