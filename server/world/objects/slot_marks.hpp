#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "server/world/objects/object_table.hpp"

namespace collided::engine {

/// A mark for each slot of an object table, by one rule. Follows the table forwards and back by the chunks that
/// changed.
class SlotMarks {
 public:
  /// Marks exactly the objects with is_marked(info). The rule must not change between calls, except after forget().
  template <class IsMarked>
  void follow(const ObjectTable& table, const IsMarked& is_marked) {
    const std::span<const std::uint64_t> versions = table.chunk_versions();
    marks_.resize(versions.size() * ObjectTable::kChunk);
    chunk_versions_.resize(versions.size(), kUnknown);
    for (std::size_t chunk = 0; chunk < versions.size(); ++chunk) {
      if (chunk_versions_[chunk] == versions[chunk]) continue;
      chunk_versions_[chunk] = versions[chunk];
      const std::size_t first = chunk * ObjectTable::kChunk;
      for (std::size_t slot = first; slot < first + ObjectTable::kChunk; ++slot) {
        const ObjectInfo* const info = slot < table.size() ? table[slot].get() : nullptr;
        marks_[slot] = info != nullptr && is_marked(*info) ? 1 : 0;
      }
    }
  }
  /// Makes the next call mark every chunk again; it may use another rule.
  void forget() { std::fill(chunk_versions_.begin(), chunk_versions_.end(), kUnknown); }

  /// 1 means marked. At least as many entries as the table has slots.
  const std::vector<std::uint8_t>& by_slot() const { return marks_; }
  std::uint8_t& operator[](std::size_t slot) { return marks_[slot]; }
  std::size_t bytes() const { return marks_.capacity() + chunk_versions_.capacity() * sizeof(std::uint64_t); }

 private:
  static constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

  std::vector<std::uint8_t> marks_;
  std::vector<std::uint64_t> chunk_versions_;  // versions of the marked chunks
};

}  // namespace collided::engine
