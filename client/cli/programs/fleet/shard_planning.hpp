#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "idl/shards/shard_map.hpp"

namespace collided::cli {

/// What a world holds, to be dealt out among shards.
struct HeldObject {
  shards::ShardBox bounds;  // sides may be infinite
  std::uint64_t triangles = 0;
  bool moving = false;
};

/// What makes a shard's work: what moves there (a step), everything (memory, questions), or its triangles (memory).
enum class LoadMeasure { moving, objects, triangles };

/// What a shard would hold: all that comes into its box and margin.
struct ExpectedLoad {
  std::uint64_t moving = 0;
  std::uint64_t objects = 0;
  std::uint64_t triangles = 0;
};

/// A proposed map, and what it would lead to. By the map's order.
struct ShardPlan {
  shards::ShardMap map;
  std::vector<ExpectedLoad> loads;
  std::uint64_t objects = 0;          // of the whole world
  std::uint64_t objects_in_many = 0;  // that more than one shard would hold
};

/// Splits a shard's box again and again, each time where the load is highest, until there are `count` in its place. A split
/// is the plane for which the side with more load has least; what comes within the margin of the plane counts on both sides,
/// so planes keep out of crowds. The same objects in another order give the same plan.
///
/// map     what is split; others of its shards stay as they are
/// split   the place of the shard that is split
/// names   of the new shards; `count` of them
/// throws  ShardMapError where no plane leaves less on both sides, or the map becomes too large
/// cost    objects * log(objects) * count
ShardPlan split_shard_box(const shards::ShardMap& map, std::size_t split, std::span<const std::string> names,
                          std::span<const HeldObject> objects, LoadMeasure measure);

/// What each shard of a map would hold.
std::vector<ExpectedLoad> expected_loads(const shards::ShardMap& map, std::span<const HeldObject> objects);
std::uint64_t load_of(const ExpectedLoad& load, LoadMeasure measure);

}  // namespace collided::cli
