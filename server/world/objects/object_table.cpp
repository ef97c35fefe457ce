#include "server/world/objects/object_table.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "server/world/objects/column.hpp"

namespace collided::engine {
namespace {

/// One thread answers about several worlds and instants, and caches what it derived from each by version.
std::uint64_t next_version() {
  static std::atomic<std::uint64_t> last{0};
  return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

bool is_part(const ObjectTable::Entry& entry) { return entry && entry->scene_part != kNoScenePart; }

constexpr std::size_t chunks_for(std::size_t slots) { return (slots + ObjectTable::kChunk - 1) / ObjectTable::kChunk; }

}  // namespace

ObjectTable::ObjectTable(std::vector<Entry> entries)
    : entries_(std::move(entries)), version_(next_version()), parts_version_(version_) {
  chunk_versions_.assign(chunks_for(size()), version_);
  for (const Entry& entry : entries_) count(entry, true);
}

void ObjectTable::count(const Entry& entry, bool joins) {
  if (!entry) return;
  const std::uint32_t one = joins ? 1U : -1U;
  counts_.objects += one;
  if (entry->moving) counts_.moving += one;
  if (entry->is_unknown) counts_.unknown += one;
}

void ObjectTable::add_slot() {
  add_to_column(entries_, {});
  if (chunk_versions_.size() < chunks_for(size())) add_to_column(chunk_versions_, std::uint64_t{0});
}

void ObjectTable::set(std::uint32_t slot, Entry entry) {
  version_ = chunk_versions_[slot / kChunk] = next_version();
  if (is_part(entries_[slot]) || is_part(entry)) parts_version_ = version_;
  count(entries_[slot], false);
  count(entry, true);
  entries_[slot] = std::move(entry);
}

void ObjectTable::note_scenes() { version_ = parts_version_ = next_version(); }

void ObjectTable::follow(const ObjectTable& newer, std::size_t slot_count,
                         const std::optional<std::span<const std::uint32_t>>& changed) {
  const std::size_t chunk_count = chunks_for(slot_count);
  resize_column(entries_, slot_count);
  resize_column(chunk_versions_, chunk_count);
  if (!changed) {
    std::copy_n(newer.entries_.begin(), slot_count, entries_.begin());
    std::copy_n(newer.chunk_versions_.begin(), chunk_count, chunk_versions_.begin());
  } else {
    for (const std::uint32_t slot : *changed) {
      if (slot >= slot_count) continue;
      entries_[slot] = newer.entries_[slot];
      chunk_versions_[slot / kChunk] = newer.chunk_versions_[slot / kChunk];
    }
  }
  version_ = newer.version_;
  parts_version_ = newer.parts_version_;
  counts_ = newer.counts_;
}

}  // namespace collided::engine
