#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "server/service/durability/journal.hpp"

/// The bytes of a journal: a word that says what it is, two slots of how much was acknowledged, records. A slot is written
/// after what it counts has been synced, in turn with the other one, so that a loss of power while it is written leaves the
/// other. A file that ends before what its slots count has lost its end, even where it was cut exactly between two records.
/// Each slot and record carries the CRC-32 of all else in it. Numbers are in this machine's byte order.
namespace collided::engine::service::journal_layout {

inline constexpr std::string_view kMagic = "collided journal 2\n";
/// Files of before there were slots: records follow at once.
inline constexpr std::string_view kMagicWithoutSlots = "collided journal 1\n";

struct Slot {
  std::uint32_t checksum = 0;  // of all that follows this number
  std::uint32_t reserved = 0;  // 0
  std::uint64_t number = 0;    // of the writing; the greater one counts
  std::uint64_t records = 0;
  std::uint64_t bytes = 0;  // of the file, this head included
};
inline constexpr std::size_t kHeadBytes = kMagic.size() + 2 * sizeof(Slot);

/// Where the slot of that number lies in the file.
inline std::uint64_t place_of_slot(std::uint64_t number) { return kMagic.size() + (number % 2) * sizeof(Slot); }
std::vector<std::byte> encode(Slot slot);

/// What the two slots say; bytes: the file's, at least kHeadBytes of them.
struct Head {
  std::optional<Slot> newest;  // nothing where neither fits its checksum
  bool is_whole = false;       // both do
};
Head head_of(std::span<const std::byte> bytes);

std::uint64_t bytes_of(const Journal::Entry& entry);
std::vector<std::byte> encode(const Journal::Entry& entry, bool is_erased);

struct Record {
  Journal::Entry entry;
  bool is_erased = false;
  std::uint64_t bytes = 0;
};
/// The record at the start of the bytes; nothing where there is no whole one.
std::optional<Record> record_at(std::span<const std::byte> bytes);

}  // namespace collided::engine::service::journal_layout
