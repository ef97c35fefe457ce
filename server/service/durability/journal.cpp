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
/// Room requested beyond the bytes to be written: removals are records too.
constexpr std::uint64_t kSpare = 4'096;

bool starts_with(std::span<const std::byte> bytes, std::string_view word) {
  return bytes.size() >= word.size() && std::memcmp(bytes.data(), word.data(), word.size()) == 0;
}

/// The digits between the stem and the line feed; empty if the file begins differently.
std::string number_of_layout(std::span<const std::byte> file) {
  constexpr std::size_t kMostDigits = 9;
  std::string digits;
  if (!starts_with(file, layout::kMagicStem)) return digits;
  for (const std::byte byte : file.subspan(layout::kMagicStem.size())) {
    const char c = static_cast<char>(byte);
    if (c == '\n') return digits;
    if (c < '0' || c > '9' || digits.size() == kMostDigits) return {};
    digits += c;
  }
  return {};
}

}  // namespace

Journal::Journal(std::unique_ptr<Disk> disk, std::string name) : disk_(std::move(disk)), name_(std::move(name)) {
  live_bytes_ = layout::kHeadBytes;
  read();
  is_worth_keeping_ = may_have_lost_;
}

void Journal::read() {
  const std::optional<std::vector<std::byte>> bytes = disk_->read(name_);
  if (!bytes) return;
  left_ = Left::unknown;
  const std::span<const std::byte> file = *bytes;
  if (!starts_with(file, layout::kMagic)) {
    other_layout_ = number_of_layout(file);
    if (!other_layout_.empty()) return;
    damage_ = fmt::format("{} is not a journal; nothing of it was taken", name_);
    may_have_lost_ = true;
    return;
  }
  if (file.size() < layout::kHeadBytes) {
    damage_ = fmt::format("{} ends within its head, at byte {}; all that it held is lost", name_, file.size());
    may_have_lost_ = true;
    return;
  }
  read_slots(file);
}

void Journal::read_slots(std::span<const std::byte> file) {
  const layout::Head head = layout::head_of(file);
  const bool are_records_whole = read_records(file, layout::kHeadBytes);
  const std::uint64_t reported_bytes = head.newest ? head.newest->bytes : 0;
  if (file_bytes_ < reported_bytes) {
    damage_ += fmt::format(
        "{}{}: {} records and {} bytes were acknowledged, {} and {} are left; what came after is lost",
        damage_.empty() ? "" : ". ", name_, head.newest->records, reported_bytes, file_records_, file_bytes_);
    may_have_lost_ = true;
  } else if (!are_records_whole && head.newest) {
    damage_ += "; none of it had been acknowledged";
  } else if (!head.newest) {
    damage_ += fmt::format("{}{}: its head is damaged; whether records are missing at its end is not known",
                           damage_.empty() ? "" : ". ", name_);
    may_have_lost_ = true;
  } else if (!head.is_whole) {
    damage_ = fmt::format("{}: one of the two counts in its head is damaged; by the other one nothing is lost", name_);
  }
  if (head.newest) left_ = head.newest->is_closed != 0 ? Left::closed : Left::open;
  if (!damage_.empty()) return;
  slot_number_ = head.newest->number;
  has_file_ = true;
}

/// Reads records from byte `from` on; false if one is cut or damaged. Counts the file's bytes up to there.
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

const Journal::Entry* Journal::find(const std::string& key) const {
  const auto place = places_.find(key);
  return place == places_.end() ? nullptr : &*place->second;
}

/// Without memory it throws and leaves the entries as they were.
void Journal::apply(Entry entry, bool is_erased) {
  const auto place = places_.find(entry.key);
  const bool is_known = place != places_.end();
  const std::uint64_t before = is_known ? layout::bytes_of(*place->second) : 0;
  const std::uint64_t after = is_erased ? 0 : layout::bytes_of(entry);
  if (is_erased && is_known) {
    const std::list<Entry>::iterator known = place->second;
    places_.erase(place);
    entries_.erase(known);
  } else if (is_known) {
    // The known key stays where it is, since places_ refers to it.
    place->second->text = std::move(entry.text);
    place->second->blob = std::move(entry.blob);
  } else if (!is_erased) {
    std::list<Entry> one;
    one.push_back(std::move(entry));
    places_.emplace(one.front().key, one.begin());
    entries_.splice(entries_.end(), one);
  }
  live_bytes_ = live_bytes_ - before + after;
}

void Journal::change(std::span<const std::string> erased, std::span<const Entry> put, Sync sync) {
  try {
    std::vector<std::byte> records;
    std::uint64_t count = 0;
    const auto add = [&](const Entry& entry, bool is_erased) {
      const std::vector<std::byte> record = layout::encode(entry, is_erased);
      records.insert(records.end(), record.begin(), record.end());
      ++count;
      apply(entry, is_erased);
    };
    for (const std::string& key : erased) {
      if (find(key) != nullptr) add({.key = key, .text = {}, .blob = {}}, true);
    }
    const bool is_all_kept = has_file_ && problem_.empty();
    for (const Entry& entry : put) {
      // Commands repeated at the start are already in the file.
      const Entry* const known = find(entry.key);
      if (known == nullptr || *known != entry || !is_all_kept) add(entry, false);
    }
    if (count > 0) write(records, count, sync);
  } catch (const std::bad_alloc&) { fail_for_memory(); }
}

/// After this the content of the file is unknown. The text is short enough to need no allocation.
void Journal::fail_for_memory() {
  has_file_ = false;
  problem_ = "no memory left";
}

bool Journal::has_room(std::uint64_t bytes) {
  if ((!has_file_ || !problem_.empty()) && !rewrite()) return false;
  if (disk_->reserve(name_, bytes + waiting_.size() + kSpare)) return true;
  problem_ = fmt::format("{} cannot be written: {}", name_, std::strerror(errno));
  return false;
}

void Journal::clear() {
  places_.clear();
  entries_.clear();
  live_bytes_ = layout::kHeadBytes;
  damage_.clear();
  may_have_lost_ = is_worth_keeping_ = false;
  static_cast<void>(rewrite());
}

void Journal::open() {
  if (!has_file_) static_cast<void>(rewrite());
  else mark(false);
}

void Journal::close() {
  if (has_file_) mark(true);
}

/// Writes both slots, so that damage to one of them does not hide how the file was left.
void Journal::mark(bool is_closed) {
  for (int i = 0; i < 2; ++i) {
    const layout::Slot slot{
        .is_closed = is_closed ? 1U : 0U, .number = slot_number_ + 1, .records = file_records_, .bytes = file_bytes_};
    if (!disk_->overwrite(name_, layout::place_of_slot(slot.number), layout::encode(slot))) return;
    if (!disk_->sync(name_)) return;
    slot_number_ = slot.number;
  }
}

/// Appends the records and, once they are on disk, writes the slot that counts them. `nothing` leaves the file as it
/// was: there was no room.
Journal::Appended Journal::append(std::span<const std::byte> records, std::uint64_t count, Sync sync) {
  if (!disk_->append(name_, records)) {
    const int why = errno;
    const bool is_as_before = (why == ENOSPC || why == EDQUOT) && disk_->cut(name_, file_bytes_);
    errno = why;
    return is_as_before ? Appended::nothing : Appended::unknown;
  }
  if (sync == Sync::now && !disk_->sync(name_)) return Appended::unknown;
  return count_records(file_records_ + count, file_bytes_ + records.size(), sync) ? Appended::all : Appended::unknown;
}

bool Journal::count_records(std::uint64_t records, std::uint64_t bytes, Sync sync) {
  const layout::Slot slot{.number = slot_number_ + 1, .records = records, .bytes = bytes};
  if (!disk_->overwrite(name_, layout::place_of_slot(slot.number), layout::encode(slot))) return false;
  if (sync == Sync::now && !disk_->sync(name_)) return false;
  slot_number_ = slot.number;
  file_records_ = slot.records;
  file_bytes_ = slot.bytes;
  return true;
}

void Journal::write(std::span<const std::byte> records, std::uint64_t count, Sync sync) {
  if (!has_file_) return static_cast<void>(rewrite());
  // Records that found no room before go first: the order counts, and a removal must not overtake what it removes.
  waiting_.insert(waiting_.end(), records.begin(), records.end());
  waiting_records_ += count;
  if (file_bytes_ > kMostStale * live_bytes_ + kSmall && rewrite()) return;
  switch (append(waiting_, waiting_records_, sync)) {
    case Appended::all:
      waiting_.clear();
      waiting_records_ = 0;
      problem_.clear();
      return;
    case Appended::nothing:
      problem_ = fmt::format("{} cannot be written: {}", name_, std::strerror(errno));
      // A new file may still be smaller, and waiting records must not grow without limit.
      if (waiting_.size() > live_bytes_ || file_bytes_ > live_bytes_) static_cast<void>(rewrite());
      return;
    case Appended::unknown: break;
  }
  // It is now unknown whether the records are in the file, and records after a cut one would be lost with it.
  const int why = errno;
  static_cast<void>(disk_->cut(name_, file_bytes_));
  errno = why;
  has_file_ = false;
  static_cast<void>(rewrite());
}

/// Writes all live entries to a new file, then renames it over the old one. The old one stays until then, and is
/// appended to further if the new one found no room. False: problem() says why.
bool Journal::rewrite() {
  const std::string summand = name_ + ".new";
  const std::uint64_t bytes = live_bytes_;
  bool done = disk_->create(summand) && disk_->append(summand, std::as_bytes(std::span(layout::kMagic)));
  for (const std::uint64_t number : {0, 1}) {
    done = done && disk_->append(summand, layout::encode(layout::Slot{
                                              .number = number, .records = entries_.size(), .bytes = bytes}));
  }
  for (const Entry& entry : entries_) done = done && disk_->append(summand, layout::encode(entry, false));
  done = done && disk_->sync(summand);
  // The damaged file may contain more than this program can recover.
  if (done && is_worth_keeping_) static_cast<void>(disk_->link(name_, name_ + ".damaged"));
  if (done) {
    done = disk_->rename(summand, name_);
    has_file_ = done;  // a rename that failed may have been done partly
  }
  problem_ = done ? std::string() : fmt::format("{} cannot be written: {}", name_, std::strerror(errno));
  if (!done) {
    // A partial file is useless and takes room that the old one may need.
    static_cast<void>(disk_->remove(summand));
    return false;
  }
  is_worth_keeping_ = false;
  waiting_.clear();
  waiting_records_ = 0;
  slot_number_ = 1;
  file_records_ = entries_.size();
  file_bytes_ = bytes;
  return true;
}

}  // namespace collided::engine::service
