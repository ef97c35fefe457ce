#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "idl/shards/shard_map.hpp"

namespace collided::cli {

/// An object of a world that is distributed to shards.
struct HeldObject {
  shards::ShardBox bounds;  // sides may be infinite
  std::uint64_t triangles = 0;
  bool moving = false;
};

/// What counts as a shard's work: moving objects (steps), all objects (memory, questions), or triangles (memory).
enum class LoadMeasure { moving, objects, triangles };

/// What a shard would hold: everything that comes into its box and margin.
struct ExpectedLoad {
  std::uint64_t moving = 0;
  std::uint64_t objects = 0;
  std::uint64_t triangles = 0;
};

/// A proposed map, and its consequences. In the map's order.
struct ShardPlan {
  shards::ShardMap map;
  std::vector<ExpectedLoad> loads;
  std::uint64_t objects = 0;          // of the whole world
  std::uint64_t objects_in_many = 0;  // held by more than one shard
};

/// Splits a shard's box repeatedly, each time where the load is highest, until it is replaced by `count` boxes. Each
/// plane minimises the load of the side with more load; objects within the margin of the plane count on both sides, so
/// planes avoid crowds. The same objects in another order give the same plan.
///
/// map     the map to split; its other shards stay unchanged
/// split   the position of the shard to split
/// names   of the new shards; `count` of them
/// throws  ShardMapError if no plane leaves less on both sides, or the map becomes too large
/// cost    objects * log(objects) * count
ShardPlan split_shard_box(const shards::ShardMap& map, std::size_t split, std::span<const std::string> names,
                          std::span<const HeldObject> objects, LoadMeasure measure);

/// What each shard of a map would hold.
std::vector<ExpectedLoad> expected_loads(const shards::ShardMap& map, std::span<const HeldObject> objects);
std::uint64_t load_of(const ExpectedLoad& load, LoadMeasure measure);

}  // namespace collided::cli
