#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "server/world/objects/object_table.hpp"

namespace collided::engine {

/// A mark for each slot of an object table, by one rule. Follows the table by the chunks that changed, forwards and back.
class SlotMarks {
 public:
  /// Marks exactly the objects with is_marked(info). The rule must be that of the calls before, up to forget().
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
  /// Every chunk is marked anew in the next call, which may have another rule.
  void forget() { std::fill(chunk_versions_.begin(), chunk_versions_.end(), kUnknown); }

  /// 1: marked. At least as many as the table has slots.
  const std::vector<std::uint8_t>& by_slot() const { return marks_; }
  std::uint8_t& operator[](std::size_t slot) { return marks_[slot]; }
  std::size_t bytes() const { return marks_.capacity() + chunk_versions_.capacity() * sizeof(std::uint64_t); }

 private:
  static constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

  std::vector<std::uint8_t> marks_;
  std::vector<std::uint64_t> chunk_versions_;  // of what is marked
};

}  // namespace collided::engine
