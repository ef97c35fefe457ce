#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "server/world/objects/object.hpp"

namespace collided::engine {

/// Numbers of the open contacts by their pair: a table of open addressing with linear probing (Knuth, TAOCP 3, 6.4,
/// Algorithms L and R). The pairs themselves stand with the contacts, so an entry takes 8 bytes and a pair that is not
/// there is known as such without reading them.
/// Always: at most half of the entries are used.
class PairIndex {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// The pair's number, or kNone. has_pair(number): whether that number belongs to the pair.
  template <class HasPair>
  std::uint32_t find(ObjectId a, ObjectId b, HasPair&& has_pair) const {
    if (entries_.empty()) return kNone;
    const std::uint32_t tag = tag_of(a, b);
    for (std::size_t at = tag & mask_; entries_[at].number != kNone; at = (at + 1) & mask_) {
      if (entries_[at].tag == tag && has_pair(entries_[at].number)) return entries_[at].number;
    }
    return kNone;
  }
  /// Prefetches where a pair's search begins. Always inline: the compiler leaves out calls of what only prefetches.
  [[gnu::always_inline]] void prefetch(ObjectId a, ObjectId b) const {
    if (!entries_.empty()) __builtin_prefetch(&entries_[tag_of(a, b) & mask_]);
  }
  /// The number that the pair has, if it is there; else kNone, or seldom another pair's.
  std::uint32_t guess(ObjectId a, ObjectId b) const {
    return find(a, b, [](std::uint32_t) { return true; });
  }
  /// The pair must not be there.
  void add(ObjectId a, ObjectId b, std::uint32_t number) {
    if (2 * (count_ + 1) > entries_.size()) grow();
    put({tag_of(a, b), number});
    ++count_;
  }
  /// The pair must be there under this number.
  void remove(ObjectId a, ObjectId b, std::uint32_t number) {
    std::size_t hole = place_of(a, b, number);
    --count_;
    // Entries after the hole move into it unless that would put them before the place where their search begins.
    for (std::size_t at = (hole + 1) & mask_; entries_[at].number != kNone; at = (at + 1) & mask_) {
      const std::size_t from_home = (at - entries_[at].tag) & mask_;
      if (from_home < ((at - hole) & mask_)) continue;
      entries_[hole] = entries_[at];
      hole = at;
    }
    entries_[hole].number = kNone;
  }
  /// The pair, which is there under the number `from`, gets the number `to`.
  void renumber(ObjectId a, ObjectId b, std::uint32_t from, std::uint32_t to) {
    entries_[place_of(a, b, from)].number = to;
  }

 private:
  struct Entry {
    std::uint32_t tag = 0;
    std::uint32_t number = kNone;
  };

  static std::uint32_t tag_of(ObjectId a, ObjectId b) {
    // Multiplicative hashing (Knuth, TAOCP 3, 6.4) of both ids; the upper half depends on all their bits.
    const std::uint64_t mixed = (a * 0x9e3779b97f4a7c15u) ^ ((b + 0x7f4a7c15u) * 0xc2b2ae3d27d4eb4fu);
    return static_cast<std::uint32_t>(((mixed ^ (mixed >> 29)) * 0xbf58476d1ce4e5b9u) >> 32);
  }
  std::size_t place_of(ObjectId a, ObjectId b, std::uint32_t number) const {
    std::size_t at = tag_of(a, b) & mask_;
    while (entries_[at].number != number) at = (at + 1) & mask_;
    return at;
  }
  void put(const Entry& entry) {
    std::size_t at = entry.tag & mask_;
    while (entries_[at].number != kNone) at = (at + 1) & mask_;
    entries_[at] = entry;
  }
  void grow() {
    std::vector<Entry> old(entries_.empty() ? 16 : 2 * entries_.size());
    old.swap(entries_);
    mask_ = entries_.size() - 1;
    for (const Entry& entry : old) {
      if (entry.number != kNone) put(entry);
    }
  }

  std::vector<Entry> entries_;  // a power of two of them
  std::size_t mask_ = 0;
  std::size_t count_ = 0;
};

}  // namespace collided::engine
