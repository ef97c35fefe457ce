#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/world/objects/object.hpp"

namespace collided::engine {

/// Every object by slot; a free slot is null. The infos never change: a new definition puts a new one in.
///
/// Whatever is derived from the table can be brought up to date by what changed: each chunk of slots has the version at
/// which it last did.
/// Always: one version stands for one content, of a chunk or of the whole, in all tables of the process; 0 is an empty one's.
/// threads  as any value: one writes, or any read
class ObjectTable {
 public:
  using Entry = std::shared_ptr<const ObjectInfo>;
  static constexpr std::size_t kChunk = 64;  // slots

  /// What is counted over all objects, so that asking for it costs nothing.
  struct ObjectCounts {
    std::uint32_t objects = 0;
    std::uint32_t moving = 0;
    std::uint32_t unknown = 0;  // of which it is not known what is in them
  };

  ObjectTable() = default;
  explicit ObjectTable(std::vector<Entry> entries);

  std::size_t size() const { return entries_.size(); }
  const Entry& operator[](std::size_t slot) const { return entries_[slot]; }
  std::vector<Entry>::const_iterator begin() const { return entries_.begin(); }
  std::vector<Entry>::const_iterator end() const { return entries_.end(); }
  /// Null: no such object.
  const ObjectInfo* find(ObjectId id) const {
    const ObjectInfo* const found = slot_of(id) < size() ? entries_[slot_of(id)].get() : nullptr;
    return found != nullptr && found->id == id ? found : nullptr;
  }

  const ObjectCounts& counts() const { return counts_; }
  std::uint64_t version() const { return version_; }
  /// Changes only with the parts of scenes, or the scenes themselves.
  std::uint64_t parts_version() const { return parts_version_; }
  /// By chunk. A chunk at the end that is not complete counts as filled up with free slots.
  std::span<const std::uint64_t> chunk_versions() const { return chunk_versions_; }

  // Changing it.
  void add_slot();
  void set(std::uint32_t slot, Entry entry);
  /// Scenes came or went, with parts or without.
  void note_scenes();
  /// Becomes equal to the first slots of `newer`, behind which all are free.
  ///
  /// changed  the only slots that differ, so that the cost is theirs; nothing: any may
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
