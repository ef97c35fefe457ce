#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/world/objects/object.hpp"

namespace collided::engine {

/// Every object by slot; a free slot is null. The infos never change: a new definition replaces the entry.
///
/// Data derived from the table can be updated incrementally: each chunk of slots has the version of its last change.
/// Always: one version stands for one content, of a chunk or of the whole table, in all tables of the process; 0 is
/// that of an empty one.
/// threads  as any value: one writes, or any read
class ObjectTable {
 public:
  using Entry = std::shared_ptr<const ObjectInfo>;
  static constexpr std::size_t kChunk = 64;  // slots

  /// Totals over all objects, kept up to date.
  struct ObjectCounts {
    std::uint32_t objects = 0;
    std::uint32_t moving = 0;
    std::uint32_t unknown = 0;  // objects with unknown content
  };

  ObjectTable() = default;
  explicit ObjectTable(std::vector<Entry> entries);

  std::size_t size() const { return entries_.size(); }
  const Entry& operator[](std::size_t slot) const { return entries_[slot]; }
  std::vector<Entry>::const_iterator begin() const { return entries_.begin(); }
  std::vector<Entry>::const_iterator end() const { return entries_.end(); }
  /// Null if there is no such object.
  const ObjectInfo* find(ObjectId id) const {
    const ObjectInfo* const found = slot_of(id) < size() ? entries_[slot_of(id)].get() : nullptr;
    return found != nullptr && found->id == id ? found : nullptr;
  }

  const ObjectCounts& counts() const { return counts_; }
  std::uint64_t version() const { return version_; }
  /// Changes only when scenes or their parts change.
  std::uint64_t parts_version() const { return parts_version_; }
  /// Version of each chunk. An incomplete chunk at the end counts as filled up with free slots.
  std::span<const std::uint64_t> chunk_versions() const { return chunk_versions_; }

  // Changing it.
  void add_slot();
  void set(std::uint32_t slot, Entry entry);
  /// Scenes were added or removed, with parts or without.
  void note_scenes();
  /// Becomes equal to the first slots of `newer`; all later slots of `newer` must be free.
  ///
  /// changed  the only slots that differ, which determine the cost; nothing: any may differ
  void follow(const ObjectTable& newer, std::size_t slot_count,
              const std::optional<std::span<const std::uint32_t>>& changed);

 private:
  void count(const Entry& entry, bool joins);

  std::vector<Entry> entries_;
  std::vector<std::uint64_t> chunk_versions_;
  std::uint64_t version_ = 0;
  std::uint64_t parts_version_ = 0;
  ObjectCounts counts_;
};

}  // namespace collided::engine
