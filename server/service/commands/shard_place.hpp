#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "idl/shards/shard_map.hpp"
#include "server/geometry/aabb.hpp"

namespace collided::engine::service {

/// What this server holds of a world that several servers share.
struct ShardPlace {
  std::string name;
  Aabb held;                      // it has everything that comes into this box
  std::uint64_t fingerprint = 0;  // of the map
};

inline ShardPlace shard_place(const shards::ShardMap& map, std::size_t place) {
  const shards::ShardBox& held = map.held_by(place);
  return {.name = map.at(place).name,
          .held = {.low = Vec3(held.low.data()), .high = Vec3(held.high.data())},
          .fingerprint = map.fingerprint()};
}

}  // namespace collided::engine::service
