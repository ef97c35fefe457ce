#pragma once

#include <cstdint>

#include "server/world/objects/object.hpp"
#include "server/world/objects/tag_index.hpp"

namespace collided::engine {

/// Numbers of the open contacts by their pair; the pairs themselves are stored with the contacts.
class PairIndex {
 public:
  static constexpr std::uint32_t kNone = TagIndex::kNone;

  /// The pair's number, or kNone. has_pair(number): true if the number belongs to the pair.
  template <class HasPair>
  std::uint32_t find(ObjectId a, ObjectId b, HasPair&& has_pair) const {
    return index_.find(tag_of(a, b), has_pair);
  }
  /// Prefetches the start of a pair's search. Always inline: the compiler drops calls of functions that only prefetch.
  [[gnu::always_inline]] void prefetch(ObjectId a, ObjectId b) const { index_.prefetch(tag_of(a, b)); }
  /// The pair's number if it is there; else kNone, or seldom another pair's.
  std::uint32_t guess(ObjectId a, ObjectId b) const {
    return find(a, b, [](std::uint32_t) { return true; });
  }
  /// Adds a pair, which must not be there.
  void add(ObjectId a, ObjectId b, std::uint32_t number) { index_.add(tag_of(a, b), number); }
  /// Removes a pair, which must be there under this number.
  void remove(ObjectId a, ObjectId b, std::uint32_t number) { index_.remove(tag_of(a, b), number); }
  /// Replaces the number `from` of an existing pair by `to`.
  void renumber(ObjectId a, ObjectId b, std::uint32_t from, std::uint32_t to) {
    index_.renumber(tag_of(a, b), from, to);
  }

 private:
  static std::uint32_t tag_of(ObjectId a, ObjectId b) {
    // Multiplicative hashing (Knuth, TAOCP 3, 6.4) of both ids; the upper half depends on all their bits.
    const std::uint64_t mixed = (a * 0x9e3779b97f4a7c15u) ^ ((b + 0x7f4a7c15u) * 0xc2b2ae3d27d4eb4fu);
    return static_cast<std::uint32_t>(((mixed ^ (mixed >> 29)) * 0xbf58476d1ce4e5b9u) >> 32);
  }

  TagIndex index_;
};

}  // namespace collided::engine
