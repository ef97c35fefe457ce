#include "server/intake/scene_file/scene_index.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>

namespace collided::engine {
namespace {

constexpr std::size_t kBlockBytes = 64;
constexpr char kMagic[8] = {'C', 'S', 'C', 'N', 'I', 'D', 'X', '1'};
constexpr std::uint32_t kByteOrder = 0x01020304;

struct IndexEntry {
  std::uint64_t mesh = 0;  // 0: the scene's mesh, 1 + i: object i's
  std::uint64_t first_byte = 0;
  std::uint64_t byte_count = 0;
};

/// The last bytes of the file.
struct LastRecord {
  std::uint64_t table_bytes = 0;
  std::uint64_t list_first_byte = 0;
  std::uint32_t entry_count = 0;
  std::uint32_t byte_order = kByteOrder;
  std::uint8_t spare[32] = {};
  char magic[8] = {};
};
static_assert(sizeof(LastRecord) == kBlockBytes);

std::size_t whole_blocks(std::size_t byte_count) { return (byte_count + kBlockBytes - 1) / kBlockBytes * kBlockBytes; }

template <class Record>
void append(std::vector<std::byte>& to, std::span<const Record> records) {
  const auto bytes = std::as_bytes(records);
  to.insert(to.end(), bytes.begin(), bytes.end());
}

bool all_zero(std::span<const char> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](char byte) { return byte == 0; });
}

/// Reads the last record. False if the file does not end in a consistent one.
bool read_last(std::span<const char> file, LastRecord& last) {
  if (file.size() < sizeof(LastRecord)) return false;
  std::memcpy(&last, file.data() + file.size() - sizeof(LastRecord), sizeof(LastRecord));
  return std::memcmp(last.magic, kMagic, sizeof(kMagic)) == 0 && last.byte_order == kByteOrder &&
         last.table_bytes <= last.list_first_byte && last.list_first_byte <= file.size() - sizeof(LastRecord) &&
         file.size() - sizeof(LastRecord) - last.list_first_byte == last.entry_count * sizeof(IndexEntry);
}

SavedIndex kept(std::span<const std::byte> bytes, const std::shared_ptr<const void>& keeper) {
  if (keeper) return {bytes, keeper};
  void* copy = std::aligned_alloc(kBlockBytes, whole_blocks(bytes.size()));
  if (copy == nullptr) throw std::bad_alloc();
  std::memcpy(copy, bytes.data(), bytes.size());
  return {{static_cast<const std::byte*>(copy), bytes.size()},
          std::shared_ptr<const void>(copy, [](const void* p) { std::free(const_cast<void*>(p)); })};
}

}  // namespace

std::vector<std::span<const std::byte>> index_section(const Scene& scene, std::size_t before_bytes,
                                                      std::vector<std::byte>& padding, std::vector<std::byte>& list) {
  std::vector<std::span<const std::byte>> pieces;
  std::vector<IndexEntry> entries;
  padding.assign(kBlockBytes, std::byte{0});
  std::size_t at = before_bytes;
  const auto align = [&] {
    const std::size_t missing = whole_blocks(at) - at;
    if (missing > 0) pieces.push_back(std::span(padding).first(missing));
    at += missing;
  };
  const auto add = [&](std::uint64_t mesh, const SavedIndex& index) {
    if (index.bytes.empty()) return;
    align();
    entries.push_back({mesh, at, index.bytes.size()});
    pieces.push_back(index.bytes);
    at += index.bytes.size();
  };
  add(0, scene.index);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) add(1 + i, scene.objects[i].index);
  if (entries.empty()) return {};
  align();
  LastRecord last{
      .table_bytes = before_bytes, .list_first_byte = at, .entry_count = static_cast<std::uint32_t>(entries.size())};
  std::memcpy(last.magic, kMagic, sizeof(kMagic));
  append<IndexEntry>(list, entries);
  append<LastRecord>(list, {&last, 1});
  pieces.push_back(list);
  return pieces;
}

std::size_t table_bytes(std::span<const char> file) {
  LastRecord last;
  return read_last(file, last) ? last.table_bytes : file.size();
}

bool attach_indexes(std::span<const char> file, const std::shared_ptr<const void>& keeper, Scene& scene) {
  LastRecord last;
  if (!read_last(file, last)) return true;
  const auto bytes = std::as_bytes(file);
  // `told` is the end of the known bytes; the padding between must be zero. Indexes must follow each other, so copies
  // of them take no more memory than the file.
  std::uint64_t told = last.table_bytes;
  std::uint64_t after = 0;
  for (std::uint32_t i = 0; i < last.entry_count; ++i) {
    IndexEntry entry;
    std::memcpy(&entry, file.data() + last.list_first_byte + i * sizeof(IndexEntry), sizeof(IndexEntry));
    const bool fits = entry.mesh >= after && entry.mesh <= scene.objects.size() && entry.byte_count > 0 &&
                      entry.first_byte >= told && entry.first_byte <= last.list_first_byte &&
                      entry.byte_count <= last.list_first_byte - entry.first_byte &&
                      all_zero(file.subspan(told, entry.first_byte - told));
    if (!fits) {
      forget_indexes(scene);
      return false;
    }
    after = entry.mesh + 1;
    told = entry.first_byte + entry.byte_count;
    SavedIndex& index = entry.mesh == 0 ? scene.index : scene.objects[entry.mesh - 1].index;
    index = kept(bytes.subspan(entry.first_byte, entry.byte_count), keeper);
  }
  const std::span<const char> spare(reinterpret_cast<const char*>(last.spare), sizeof last.spare);
  const bool is_whole = all_zero(file.subspan(told, last.list_first_byte - told)) && all_zero(spare);
  if (!is_whole) forget_indexes(scene);
  return is_whole;
}

void forget_indexes(Scene& scene) {
  scene.index = {};
  for (SceneObject& object : scene.objects) object.index = {};
}

}  // namespace collided::engine
