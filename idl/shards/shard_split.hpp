#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "idl/shards/shard_map.hpp"

/// How the shards of a world change while it runs: one is split, and others take its place.
namespace collided::shards {

/// Which shard of a map is split, and into which of the map that succeeds it.
struct ShardSplit {
  std::size_t from = 0;           // by its place in the map
  std::vector<std::size_t> into;  // by their places in the next one
};

/// throws  ShardMapError where the next map differs in anything but one shard, in whose place others fill its box
ShardSplit split_between(const ShardMap& map, const ShardMap& next);

/// How far a split has come. A server keeps it; clients ask for it.
///
/// joining    publishers tell the new shards, too, and watches watch them; questions go by the map before
/// in_force   questions go by the next map
/// done       the shard that was split holds nothing any more
/// withdrawn  the next map does not come; all is as before
enum class SuccessionPhase { joining, in_force, done, withdrawn };

std::string_view name_of(SuccessionPhase phase);
std::optional<SuccessionPhase> succession_phase(std::string_view name);

/// A map that succeeds another one.
struct MapSuccession {
  std::uint64_t revision = 0;  // grows with each phase: of two that are told, the higher one holds
  SuccessionPhase phase = SuccessionPhase::joining;
  std::uint64_t from = 0;  // fingerprint of the map before
  ShardMap next;
};

/// A fingerprint as the wire has it: 16 hexadecimal digits.
std::string fingerprint_text(std::uint64_t fingerprint);
std::optional<std::uint64_t> fingerprint_of(std::string_view text);

/// The JSON object {"revision", "phase", "from", "map"}, as text: of the command `succession`, and in the answer of `shard`.
std::string succession_text(const MapSuccession& succession);
/// The same back; other members of the object are left alone.
///
/// throws  ShardMapError for anything that it does not say
MapSuccession parse_succession(std::string_view json);

}  // namespace collided::shards
