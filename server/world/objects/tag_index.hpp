#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace collided::engine {

/// Numbers of items by a hash of their key: a table of open addressing with linear probing (Knuth, TAOCP 3, 6.4,
/// Algorithms L and R). The keys are stored with the items, so an entry takes 8 bytes and most missing keys are
/// detected without reading any key.
/// Always: at most the given share of the entries is used.
class TagIndex {
 public:
  /// eighths_used  up to 7; the mean search for a missing key reads 2.5 entries if half are used, 32 if seven eighths
  ///               are
  explicit TagIndex(std::size_t eighths_used = 4) : eighths_used_(eighths_used) {}

  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// The number under this tag for which has_key(number) is true, or kNone.
  template <class HasKey>
  std::uint32_t find(std::uint32_t tag, HasKey&& has_key) const {
    if (entries_.empty()) return kNone;
    for (std::size_t at = tag & mask_; entries_[at].number != kNone; at = (at + 1) & mask_) {
      if (entries_[at].tag == tag && has_key(entries_[at].number)) return entries_[at].number;
    }
    return kNone;
  }
  /// Prefetches the start of a search. Always inline: the compiler drops calls of functions that only prefetch.
  [[gnu::always_inline]] void prefetch(std::uint32_t tag) const {
    if (!entries_.empty()) __builtin_prefetch(&entries_[tag & mask_]);
  }
  /// Adds a key, which must not be there.
  void add(std::uint32_t tag, std::uint32_t number) {
    if (8 * (count_ + 1) > eighths_used_ * entries_.size()) resize(entries_.empty() ? 16 : 2 * entries_.size());
    put({tag, number});
    ++count_;
  }
  /// The number must be there under this tag. Gives memory back once a sixteenth is used.
  void remove(std::uint32_t tag, std::uint32_t number) {
    std::size_t hole = place_of(tag, number);
    --count_;
    // Entries after the hole move into it unless that would put them before the start of their search.
    for (std::size_t at = (hole + 1) & mask_; entries_[at].number != kNone; at = (at + 1) & mask_) {
      const std::size_t from_home = (at - entries_[at].tag) & mask_;
      if (from_home < ((at - hole) & mask_)) continue;
      entries_[hole] = entries_[at];
      hole = at;
    }
    entries_[hole].number = kNone;
    if (16 * count_ < entries_.size() && entries_.size() > kLeastToShrink) resize(entries_.size() / 4);
  }
  /// Replaces the number `from` of an existing entry by `to`.
  void renumber(std::uint32_t tag, std::uint32_t from, std::uint32_t to) { entries_[place_of(tag, from)].number = to; }
  std::size_t size() const { return count_; }

 private:
  struct Entry {
    std::uint32_t tag = 0;
    std::uint32_t number = kNone;
  };
  static constexpr std::size_t kLeastToShrink = 4'096;  // smaller tables are not worth shrinking

  std::size_t place_of(std::uint32_t tag, std::uint32_t number) const {
    std::size_t at = tag & mask_;
    while (entries_[at].number != number) at = (at + 1) & mask_;
    return at;
  }
  void put(const Entry& entry) {
    std::size_t at = entry.tag & mask_;
    while (entries_[at].number != kNone) at = (at + 1) & mask_;
    entries_[at] = entry;
  }
  void resize(std::size_t size) {
    std::vector<Entry> old(size);
    old.swap(entries_);
    mask_ = size - 1;
    for (const Entry& entry : old) {
      if (entry.number != kNone) put(entry);
    }
  }

  std::size_t eighths_used_;
  std::vector<Entry> entries_;  // size is a power of two
  std::size_t mask_ = 0;
  std::size_t count_ = 0;
};

}  // namespace collided::engine
