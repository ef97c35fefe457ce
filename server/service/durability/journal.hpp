#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace collided::engine::service {

/// The files of one folder, as far as the journal needs them; the POSIX ones below, failing and forgetful ones in tests.
/// Every call says whether it was done.
class Disk {
 public:
  virtual ~Disk() = default;
  virtual std::optional<std::vector<std::byte>> read(const std::string& name) = 0;
  /// An empty file in place of whatever is there.
  virtual bool create(const std::string& name) = 0;
  virtual bool append(const std::string& name, std::span<const std::byte> bytes) = 0;
  /// In place of as many bytes that are there.
  virtual bool overwrite(const std::string& name, std::uint64_t at, std::span<const std::byte> bytes) = 0;
  /// The first so many bytes of it are left.
  virtual bool cut(const std::string& name, std::uint64_t bytes) = 0;
  /// What was appended outlives a loss of power from now on.
  virtual bool sync(const std::string& name) = 0;
  /// In place of what is there, lasting.
  virtual bool rename(const std::string& from, const std::string& to) = 0;
};
std::unique_ptr<Disk> disk_in(const std::string& folder);

/// What must outlive a crash: named entries, the last one of a name counts. Appended to a file, each record with its
/// length and checksum, and counted at its beginning once synced, so that a lost end is seen (journal_layout); rewritten beside it, synced and renamed over it once most of it is stale. A write, sync or rename
/// that failed makes the file a failed one: nothing is appended to it any more, the next entry goes to a new one with all
/// that is live, and until that has worked problem() says so.
///
/// threads  one at a time
class Journal {
 public:
  struct Entry {
    std::string key;
    std::string text;
    std::vector<std::byte> blob;
    bool operator==(const Entry&) const = default;
  };
  enum class Sync : std::uint8_t { now, later };  // later: outlives this process, not a loss of power

  /// Reads what an earlier process left. A record that is cut or does not fit its checksum ends the reading: the state
  /// before it is kept, and damage() says what was lost; so it does where fewer records are there than were acknowledged.
  Journal(std::unique_ptr<Disk> disk, std::string name);

  /// In the order of their first writing.
  const std::vector<Entry>& entries() const { return entries_; }
  /// Empty, or what was found damaged.
  const std::string& damage() const { return damage_; }
  /// Empty while everything that was put is on the disk.
  const std::string& problem() const { return problem_; }

  void put(Entry entry, Sync sync);
  void erase(std::span<const std::string> keys, Sync sync);
  void clear();

 private:
  void read();
  bool read_records(std::span<const std::byte> file, std::size_t from);
  void apply(Entry entry, bool is_erased);
  bool append(std::span<const std::byte> records, std::uint64_t count, Sync sync);
  void write(std::span<const std::byte> records, std::uint64_t count, Sync sync);
  void fail_for_memory();
  void rewrite();
  std::uint64_t live_bytes() const;

  std::unique_ptr<Disk> disk_;
  std::string name_;
  std::vector<Entry> entries_;
  std::uint64_t file_bytes_ = 0;
  std::uint64_t file_records_ = 0;
  std::uint64_t slot_number_ = 0;
  bool has_file_ = false;  // that may be appended to
  std::string damage_;
  std::string problem_;
};

}  // namespace collided::engine::service
