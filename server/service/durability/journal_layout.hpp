#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "server/service/durability/journal.hpp"

/// The bytes of a journal: a word that identifies the file, two slots that count the acknowledged bytes, then records.
/// A slot is written after the records it counts were synced, the two slots in turn, so a power loss during the write
/// leaves the other one. A file that is shorter than its slots count has lost its end, even if it was cut exactly
/// between two records. Each slot and record carries the CRC-32 of its other bytes. Numbers are in this machine's byte
/// order.
namespace collided::engine::service::journal_layout {

inline constexpr std::string_view kMagic = "collided journal 4\n";
/// The files of all versions begin with this; the number of the layout and a line feed follow.
inline constexpr std::string_view kMagicStem = "collided journal ";

/// How much of the file was acknowledged when the slot was written.
struct Slot {
  std::uint32_t checksum = 0;   // of everything after this number
  std::uint32_t is_closed = 0;  // 1: the process that wrote it was stopped properly
  std::uint64_t number = 0;     // counts the writes; the slot with the greater one is the newest
  std::uint64_t records = 0;
  std::uint64_t bytes = 0;  // of the file, this head included
};
inline constexpr std::size_t kHeadBytes = kMagic.size() + 2 * sizeof(Slot);

/// Byte of the file at which the slot of that number begins.
inline std::uint64_t place_of_slot(std::uint64_t number) { return kMagic.size() + (number % 2) * sizeof(Slot); }
/// The slot's bytes with their checksum.
std::vector<std::byte> encode(Slot slot);

/// The content of the two slots.
struct Head {
  std::optional<Slot> newest;  // nothing if neither matches its checksum
  bool is_whole = false;       // both match
};
/// bytes  of the file, at least kHeadBytes
Head head_of(std::span<const std::byte> bytes);

/// Length of the entry's record.
std::uint64_t bytes_of(const Journal::Entry& entry);
/// The record's bytes with their checksum. is_erased: the record removes the entry of this key.
std::vector<std::byte> encode(const Journal::Entry& entry, bool is_erased);

/// A record as read.
struct Record {
  Journal::Entry entry;
  bool is_erased = false;
  std::uint64_t bytes = 0;  // of the whole record
};
/// The record at the start of the bytes; nothing if no whole one is there.
std::optional<Record> record_at(std::span<const std::byte> bytes);

}  // namespace collided::engine::service::journal_layout
