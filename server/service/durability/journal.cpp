#include "server/service/durability/journal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

#include "server/service/durability/journal_layout.hpp"

namespace collided::engine::service {
namespace {

namespace layout = journal_layout;

/// The file is rewritten once it is longer than kMostStale times its live bytes plus kSmall.
constexpr std::uint64_t kMostStale = 2;
constexpr std::uint64_t kSmall = 1 << 20;

bool starts_with(std::span<const std::byte> bytes, std::string_view word) {
  return bytes.size() >= word.size() && std::memcmp(bytes.data(), word.data(), word.size()) == 0;
}

}  // namespace

Journal::Journal(std::unique_ptr<Disk> disk, std::string name) : disk_(std::move(disk)), name_(std::move(name)) {
  read();
}

void Journal::read() {
  const std::optional<std::vector<std::byte>> bytes = disk_->read(name_);
  if (!bytes) return;
  const std::span<const std::byte> file = *bytes;
  // Files without slots are read, and rewritten with slots at the next change.
  if (starts_with(file, layout::kMagicWithoutSlots)) {
    static_cast<void>(read_records(file, layout::kMagicWithoutSlots.size()));
    return;
  }
  if (!starts_with(file, layout::kMagic)) {
    damage_ = fmt::format("{} is not a journal; nothing of it was taken", name_);
    return;
  }
  if (file.size() < layout::kHeadBytes) {
    damage_ = fmt::format("{} ends within its head, at byte {}; all that it held is lost", name_, file.size());
    return;
  }
  const layout::Head head = layout::head_of(file);
  const bool are_records_whole = read_records(file, layout::kHeadBytes);
  const std::uint64_t reported_bytes = head.newest ? head.newest->bytes : 0;
  if (file_bytes_ < reported_bytes) {
    damage_ += fmt::format(
        "{}{}: {} records and {} bytes were acknowledged, {} and {} are left; what came after is lost",
        damage_.empty() ? "" : ". ", name_, head.newest->records, reported_bytes, file_records_, file_bytes_);
  } else if (!are_records_whole && head.newest) {
    damage_ += "; none of it had been acknowledged";
  } else if (!head.newest) {
    damage_ += fmt::format("{}{}: its head is damaged; whether records are missing at its end is not known",
                           damage_.empty() ? "" : ". ", name_);
  } else if (!head.is_whole) {
    damage_ = fmt::format("{}: one of the two counts in its head is damaged; by the other one nothing is lost", name_);
  }
  if (!damage_.empty()) return;
  slot_number_ = head.newest->number;
  has_file_ = true;
}

/// Reads records from byte `from` on; false where one is cut or damaged. Counts what the file holds up to there.
bool Journal::read_records(std::span<const std::byte> file, std::size_t from) {
  file_bytes_ = from;
  file_records_ = 0;
  while (file_bytes_ < file.size()) {
    const std::span<const std::byte> rest = file.subspan(file_bytes_);
    std::optional<layout::Record> record = layout::record_at(rest);
    if (!record) {
      damage_ = fmt::format("{}: the record at byte {} is cut or damaged; the {} bytes from there on were not taken",
                            name_, file_bytes_, rest.size());
      return false;
    }
    apply(std::move(record->entry), record->is_erased);
    file_bytes_ += record->bytes;
    ++file_records_;
  }
  return true;
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
    const std::vector<std::byte> record = layout::encode(entry, false);
    apply(std::move(entry), false);
    write(record, 1, sync);
  } catch (const std::bad_alloc&) { fail_for_memory(); }
}

void Journal::erase(std::span<const std::string> keys, Sync sync) {
  try {
    std::vector<std::byte> records;
    std::uint64_t count = 0;
    for (const std::string& key : keys) {
      if (std::ranges::find(entries_, key, &Entry::key) == entries_.end()) continue;
      const std::vector<std::byte> record = layout::encode({.key = key, .text = {}, .blob = {}}, true);
      records.insert(records.end(), record.begin(), record.end());
      ++count;
      apply({.key = key, .text = {}, .blob = {}}, true);
    }
    if (count > 0) write(records, count, sync);
  } catch (const std::bad_alloc&) { fail_for_memory(); }
}

/// After this nobody knows what the file holds. The text is short enough to need no allocation.
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
  std::uint64_t bytes = layout::kHeadBytes;
  for (const Entry& entry : entries_) bytes += layout::bytes_of(entry);
  return bytes;
}

/// Appends the records and, once they are on the disk, writes the slot that counts them.
bool Journal::append(std::span<const std::byte> records, std::uint64_t count, Sync sync) {
  const auto settle = [&] { return sync == Sync::later || disk_->sync(name_); };
  if (!disk_->append(name_, records) || !settle()) return false;
  const layout::Slot slot{
      .number = slot_number_ + 1, .records = file_records_ + count, .bytes = file_bytes_ + records.size()};
  if (!disk_->overwrite(name_, layout::place_of_slot(slot.number), layout::encode(slot)) || !settle()) return false;
  slot_number_ = slot.number;
  file_records_ = slot.records;
  file_bytes_ = slot.bytes;
  return true;
}

void Journal::write(std::span<const std::byte> records, std::uint64_t count, Sync sync) {
  if (!has_file_ || file_bytes_ > kMostStale * live_bytes() + kSmall) return rewrite();
  if (append(records, count, sync)) return;
  // It is unknown now whether the records are in the file, and what comes after a cut one would be lost with it. On a
  // full disk the space they took is given back, or nothing smaller could be written either.
  const int why = errno;
  static_cast<void>(disk_->cut(name_, file_bytes_));
  errno = why;
  has_file_ = false;
  rewrite();
}

/// Writes all live entries to a new file, then renames it over the old one, which stays until then.
void Journal::rewrite() {
  const std::string summand = name_ + ".new";
  const std::uint64_t bytes = live_bytes();
  bool done = disk_->create(summand) && disk_->append(summand, std::as_bytes(std::span(layout::kMagic)));
  for (const std::uint64_t number : {0, 1}) {
    done = done && disk_->append(summand, layout::encode(layout::Slot{
                                              .number = number, .records = entries_.size(), .bytes = bytes}));
  }
  for (const Entry& entry : entries_) done = done && disk_->append(summand, layout::encode(entry, false));
  done = done && disk_->sync(summand) && disk_->rename(summand, name_);
  problem_ = done ? std::string() : fmt::format("{} cannot be written: {}", name_, std::strerror(errno));
  has_file_ = done;
  if (!done) return;
  slot_number_ = 1;
  file_records_ = entries_.size();
  file_bytes_ = bytes;
}

}  // namespace collided::engine::service
