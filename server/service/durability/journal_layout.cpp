#include "server/service/durability/journal_layout.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>

namespace collided::engine::service::journal_layout {
namespace {

/// A longer part of a record is damage: a shape comes in one message.
constexpr std::uint64_t kMostRecordBytes = 64 << 20;

/// Precedes each record; key, text and blob follow.
struct RecordHead {
  std::uint32_t checksum = 0;  // of everything after this number
  std::uint32_t is_erased = 0;
  std::uint64_t key_bytes = 0;
  std::uint64_t text_bytes = 0;
  std::uint64_t blob_bytes = 0;
};

std::uint32_t checksum(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// Stores the checksum of all following bytes at the start.
void seal(std::vector<std::byte>& bytes) {
  const std::uint32_t sum = checksum(std::span(bytes).subspan(sizeof sum));
  std::memcpy(bytes.data(), &sum, sizeof sum);
}

std::optional<Slot> slot_at(std::span<const std::byte> bytes) {
  Slot slot;
  std::memcpy(&slot, bytes.data(), sizeof slot);
  if (checksum(bytes.first(sizeof slot).subspan(sizeof slot.checksum)) != slot.checksum) return std::nullopt;
  return slot;
}

}  // namespace

std::vector<std::byte> encode(Slot slot) {
  std::vector<std::byte> bytes(sizeof slot);
  std::memcpy(bytes.data(), &slot, sizeof slot);
  seal(bytes);
  return bytes;
}

Head head_of(std::span<const std::byte> bytes) {
  const std::optional<Slot> even = slot_at(bytes.subspan(place_of_slot(0)));
  const std::optional<Slot> odd = slot_at(bytes.subspan(place_of_slot(1)));
  const bool is_odd_newest = odd && (!even || odd->number > even->number);
  return {.newest = is_odd_newest ? odd : even, .is_whole = even && odd};
}

std::uint64_t bytes_of(const Journal::Entry& entry) {
  return sizeof(RecordHead) + entry.key.size() + entry.text.size() + entry.blob.size();
}

std::vector<std::byte> encode(const Journal::Entry& entry, bool is_erased) {
  const RecordHead head{0, is_erased ? 1u : 0u, entry.key.size(), entry.text.size(), entry.blob.size()};
  std::vector<std::byte> record(bytes_of(entry));
  std::memcpy(record.data(), &head, sizeof head);
  auto to = record.begin() + sizeof head;
  const auto append = [&](std::span<const std::byte> bytes) { to = std::copy(bytes.begin(), bytes.end(), to); };
  append(std::as_bytes(std::span(entry.key)));
  append(std::as_bytes(std::span(entry.text)));
  append(entry.blob);
  seal(record);
  return record;
}

std::optional<Record> record_at(std::span<const std::byte> bytes) {
  RecordHead head;
  if (bytes.size() < sizeof head) return std::nullopt;
  std::memcpy(&head, bytes.data(), sizeof head);
  // The three lengths are bounded first, so that their sum cannot overflow.
  for (const std::uint64_t part : {head.key_bytes, head.text_bytes, head.blob_bytes}) {
    if (part > kMostRecordBytes) return std::nullopt;
  }
  const std::uint64_t length = sizeof head + head.key_bytes + head.text_bytes + head.blob_bytes;
  if (length > bytes.size() || head.is_erased > 1) return std::nullopt;
  if (checksum(bytes.first(length).subspan(sizeof head.checksum)) != head.checksum) return std::nullopt;
  const auto* at = reinterpret_cast<const char*>(bytes.data()) + sizeof head;
  const auto* blob = bytes.data() + sizeof head + head.key_bytes + head.text_bytes;
  return Record{.entry = {.key = {at, head.key_bytes},
                          .text = {at + head.key_bytes, head.text_bytes},
                          .blob = {blob, blob + head.blob_bytes}},
                .is_erased = head.is_erased != 0,
                .bytes = length};
}

}  // namespace collided::engine::service::journal_layout
