#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

/// Sums over the objects of one state, in which ids, slots and order do not show: equal where two worlds hold the same
/// objects at the same poses, bit for bit. Each object belongs to a group by its name, so that two digests that differ
/// tell which objects may be meant. Parts of static scenes are left out: scene_fingerprint() has them.
struct WorldDigest {
  static constexpr std::size_t kGroups = 64;
  /// The last of them have the objects of no publisher: what scenes and commands brought.
  static constexpr std::size_t kUnpublishedGroups = 16;
  /// By group, two numbers: the sum of the objects' hashes, and of the products of hash and key of the name, both modulo
  /// 2^61 - 1.
  std::array<std::uint64_t, 2 * kGroups> sums{};
  bool operator==(const WorldDigest&) const = default;
};

/// cost  the objects once
WorldDigest digest_of(const Snapshot& state);

/// The name of an object in which two digests differ, where it is an object of this state and the only one of its group;
/// empty where there is none such. Of several groups that differ it is the first one's.
///
/// here, there  digests of this state, and of another world at the same instant
std::string first_difference(const Snapshot& state, const WorldDigest& here, const WorldDigest& there);

/// Of the static scenes of a state, by name and triangles, whatever their order. 0: there is none.
/// cost  the triangles once
std::uint64_t scene_fingerprint(const Snapshot& state);

}  // namespace collided::engine
