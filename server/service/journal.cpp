#include "server/service/journal.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <new>

namespace collided::service {
namespace {

constexpr std::string_view kMagic = "collided journal 1\n";
/// Rewritten beyond so many times what is live, and this.
constexpr std::uint64_t kMostStale = 2;
constexpr std::uint64_t kSmall = 1 << 20;
/// Longer ones are damage: a shape comes in one message.
constexpr std::uint64_t kMostRecordBytes = 64 << 20;

/// Before each record; what follows is key, text and blob.
struct Head {
  std::uint32_t checksum = 0;  // of all that follows this number
  std::uint32_t is_erased = 0;
  std::uint64_t key_bytes = 0;
  std::uint64_t text_bytes = 0;
  std::uint64_t blob_bytes = 0;
};

std::uint32_t checksum(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::vector<std::byte> record_of(const Journal::Entry& entry, bool is_erased) {
  const Head head{0, is_erased ? 1u : 0u, entry.key.size(), entry.text.size(), entry.blob.size()};
  std::vector<std::byte> record(sizeof head + entry.key.size() + entry.text.size() + entry.blob.size());
  std::memcpy(record.data(), &head, sizeof head);
  auto to = record.begin() + sizeof head;
  const auto append = [&](const void* data, std::size_t bytes) {
    to = std::copy_n(static_cast<const std::byte*>(data), bytes, to);
  };
  append(entry.key.data(), entry.key.size());
  append(entry.text.data(), entry.text.size());
  append(entry.blob.data(), entry.blob.size());
  const std::uint32_t sum = checksum(std::span(record).subspan(sizeof sum));
  std::memcpy(record.data(), &sum, sizeof sum);
  return record;
}

/// The record at the start of the bytes and how long it is; nothing where there is no whole one.
std::optional<Journal::Entry> entry_at(std::span<const std::byte> bytes, bool& is_erased, std::size_t& length) {
  Head head;
  if (bytes.size() < sizeof head) return std::nullopt;
  std::memcpy(&head, bytes.data(), sizeof head);
  for (const std::uint64_t part : {head.key_bytes, head.text_bytes, head.blob_bytes}) {
    if (part > kMostRecordBytes) return std::nullopt;
  }
  length = sizeof head + head.key_bytes + head.text_bytes + head.blob_bytes;
  if (length > bytes.size() || head.is_erased > 1) return std::nullopt;
  if (checksum(bytes.first(length).subspan(sizeof head.checksum)) != head.checksum) return std::nullopt;
  is_erased = head.is_erased != 0;
  const auto* at = reinterpret_cast<const char*>(bytes.data()) + sizeof head;
  const auto* blob = bytes.data() + sizeof head + head.key_bytes + head.text_bytes;
  return Journal::Entry{.key = {at, head.key_bytes},
                        .text = {at + head.key_bytes, head.text_bytes},
                        .blob = {blob, blob + head.blob_bytes}};
}

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

}  // namespace

Journal::Journal(std::unique_ptr<Disk> disk, std::string name) : disk_(std::move(disk)), name_(std::move(name)) { read(); }

void Journal::read() {
  const std::optional<std::vector<std::byte>> bytes = disk_->read(name_);
  if (!bytes) return;
  std::span<const std::byte> rest = *bytes;
  const bool is_ours = rest.size() >= kMagic.size() && std::ranges::equal(rest.first(kMagic.size()), bytes_of(kMagic));
  if (!is_ours) {
    damage_ = fmt::format("{} is not a journal; nothing of it was taken", name_);
    return;
  }
  rest = rest.subspan(kMagic.size());
  while (!rest.empty()) {
    bool is_erased = false;
    std::size_t length = 0;
    std::optional<Entry> entry = entry_at(rest, is_erased, length);
    if (!entry) {
      damage_ = fmt::format("{}: the record at byte {} is cut or damaged; the {} bytes from there on were not taken", name_,
                            bytes->size() - rest.size(), rest.size());
      return;
    }
    apply(std::move(*entry), is_erased);
    rest = rest.subspan(length);
  }
  file_bytes_ = bytes->size();
  has_file_ = true;
}

void Journal::apply(Entry entry, bool is_erased) {
  const auto known = std::ranges::find(entries_, entry.key, &Entry::key);
  if (is_erased) {
    if (known != entries_.end()) entries_.erase(known);
  } else if (known != entries_.end()) {
    *known = std::move(entry);
  } else {
    entries_.push_back(std::move(entry));
  }
}

void Journal::put(Entry entry, Sync sync) {
  try {
    const std::vector<std::byte> record = record_of(entry, false);
    apply(std::move(entry), false);
    write(record, sync);
  } catch (const std::bad_alloc&) {
    fail_for_memory();
  }
}

void Journal::erase(std::span<const std::string> keys, Sync sync) {
  try {
    std::vector<std::byte> records;
    for (const std::string& key : keys) {
      if (std::ranges::find(entries_, key, &Entry::key) == entries_.end()) continue;
      const std::vector<std::byte> record = record_of({.key = key, .text = {}, .blob = {}}, true);
      records.insert(records.end(), record.begin(), record.end());
      apply({.key = key, .text = {}, .blob = {}}, true);
    }
    if (!records.empty()) write(records, sync);
  } catch (const std::bad_alloc&) {
    fail_for_memory();
  }
}

/// Of what the file holds now nobody is sure. The text is short enough to need no memory.
void Journal::fail_for_memory() {
  has_file_ = false;
  problem_ = "no memory left";
}

void Journal::clear() {
  entries_.clear();
  damage_.clear();
  rewrite();
}

std::uint64_t Journal::live_bytes() const {
  std::uint64_t bytes = kMagic.size();
  for (const Entry& entry : entries_) bytes += sizeof(Head) + entry.key.size() + entry.text.size() + entry.blob.size();
  return bytes;
}

void Journal::write(std::span<const std::byte> record, Sync sync) {
  if (!has_file_ || file_bytes_ > kMostStale * live_bytes() + kSmall) return rewrite();
  if (!disk_->append(name_, record) || (sync == Sync::now && !disk_->sync(name_))) {
    // Whether the record is in the file is unknown now; what comes after a cut one would be lost with it. What it has
    // taken of a full disk is given back, or nothing smaller could be written either.
    const int why = errno;
    static_cast<void>(disk_->cut(name_, file_bytes_));
    errno = why;
    has_file_ = false;
    return rewrite();
  }
  file_bytes_ += record.size();
}

/// All that is live into a new file, then that one in place of the old, which stays until then.
void Journal::rewrite() {
  const std::string beside = name_ + ".new";
  bool done = disk_->create(beside) && disk_->append(beside, bytes_of(kMagic));
  for (const Entry& entry : entries_) done = done && disk_->append(beside, record_of(entry, false));
  done = done && disk_->sync(beside) && disk_->rename(beside, name_);
  problem_ = done ? std::string() : fmt::format("{} cannot be written: {}", name_, std::strerror(errno));
  has_file_ = done;
  if (done) file_bytes_ = live_bytes();
}

}  // namespace collided::service
