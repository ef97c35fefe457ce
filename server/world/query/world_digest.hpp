#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

/// Sums over the objects of one state, independent of ids, slots and order: equal if two worlds hold the same objects
/// at the same poses, bit for bit. Each object belongs to a group by its name, so that two different digests show which
/// objects may differ. Parts of static scenes are left out; see scene_fingerprint().
struct WorldDigest {
  static constexpr std::size_t kGroups = 64;
  /// The last groups hold the objects without a publisher, from scenes and commands.
  static constexpr std::size_t kUnpublishedGroups = 16;
  /// Two numbers per group: the sum of the objects' hashes, and the sum of the products of hash and name key, both
  /// modulo 2^61 - 1.
  std::array<std::uint64_t, 2 * kGroups> sums{};
  bool operator==(const WorldDigest&) const = default;
};

/// cost  one pass over the objects
WorldDigest digest_of(const Snapshot& state);

/// The name of an object in which two digests differ, if this state has it and it is the only one that differs in its
/// group; else empty. If several groups differ, the first one with a result counts.
///
/// here, there  digests of this state, and of another world at the same instant
std::string first_difference(const Snapshot& state, const WorldDigest& here, const WorldDigest& there);

/// Fingerprint of the static scenes of a state, by name and triangles, independent of their order. 0: there are none.
/// cost  one pass over the triangles
std::uint64_t scene_fingerprint(const Snapshot& state);

}  // namespace collided::engine
