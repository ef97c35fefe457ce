#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace collided::engine::service {

/// The files of one folder, as far as the journal needs them: POSIX ones (disk_in), and in tests some that fail and
/// forget. Every call returns whether it succeeded.
class Disk {
 public:
  virtual ~Disk() = default;
  /// All bytes of a file; nothing if it cannot be read.
  virtual std::optional<std::vector<std::byte>> read(const std::string& name) = 0;
  /// Makes an empty file, replacing any that exists.
  virtual bool create(const std::string& name) = 0;
  /// Appends to a file that exists.
  virtual bool append(const std::string& name, std::span<const std::byte> bytes) = 0;
  /// Replaces this many existing bytes, from byte `at` on.
  virtual bool overwrite(const std::string& name, std::uint64_t at, std::span<const std::byte> bytes) = 0;
  /// Leaves only the first `bytes` bytes of the file.
  virtual bool cut(const std::string& name, std::uint64_t bytes) = 0;
  /// After this the written bytes survive a power loss.
  virtual bool sync(const std::string& name) = 0;
  /// Replaces one file by another; after this the change survives a power loss.
  virtual bool rename(const std::string& from, const std::string& to) = 0;
  /// Removes a file; true also if it does not exist.
  virtual bool remove(const std::string& name) = 0;
  /// Gives the file a second name, replacing any file of that name.
  virtual bool link(const std::string& name, const std::string& second) = 0;
  /// Reserves this many bytes after the file's end, which appending then uses up.
  virtual bool reserve(const std::string& name, std::uint64_t bytes) = 0;
};
/// The files of an existing folder.
std::unique_ptr<Disk> disk_in(const std::string& folder);

/// A log of entries that must survive a crash: they are named, and the last one of a name counts. Records are appended
/// to a file, each with its length and checksum. Their number is written at the file's beginning once they are synced,
/// so that a lost end is noticed (journal_layout.hpp). Once most of the file is stale it is rewritten next to itself,
/// synced and renamed over the old one. Records that find no room on disk wait in memory and are written with the next
/// entry. After any other failure the file is given up: the next entry starts a new file with everything live, and
/// problem() reports the failure until that has worked. A damaged file keeps a second name, NAME.damaged, when it is
/// replaced.
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
  enum class Sync : std::uint8_t { now, later };  // later: survives this process but not a power loss
  /// How the process before this one left its file. unknown: the file is damaged.
  enum class Left : std::uint8_t { none, unknown, open, closed };

  /// Reads the file of an earlier process. A record that is cut or does not match its checksum ends the reading:
  /// records before it are kept, and damage() says what was lost, also if there are fewer records than were
  /// acknowledged.
  Journal(std::unique_ptr<Disk> disk, std::string name);

  /// The live entries, in the order in which their names were first written.
  const std::list<Entry>& entries() const { return entries_; }
  /// What was found damaged, as a sentence; empty: nothing.
  const std::string& damage() const { return damage_; }
  /// Whether acknowledged entries may be missing from entries(): damage() says how many.
  bool may_have_lost() const { return may_have_lost_; }
  Left left() const { return left_; }
  /// The number of the file's layout if another version of this program wrote it; then nothing of it was read, and it
  /// stays as it is until the first change. Empty: this version wrote it.
  const std::string& other_layout() const { return other_layout_; }
  /// Why some entries are not on disk; empty: all are.
  const std::string& problem() const { return problem_; }

  /// Removes the entries of these keys (unknown ones are ignored), then adds entries or replaces those of their keys.
  /// With Sync::now all is on disk on return, unless problem() says why not.
  void change(std::span<const std::string> erased, std::span<const Entry> put, Sync sync);
  void put(const Entry& entry, Sync sync) { change({}, std::span(&entry, 1), sync); }
  void erase(std::span<const std::string> keys, Sync sync) { change(keys, {}, sync); }
  /// Whether records of this many bytes, and some more, will find room; makes a file if there is none yet.
  bool has_room(std::uint64_t bytes);
  /// Removes all entries, and forgets damage(). The file counts as open again.
  void clear();
  /// Records that a process uses the file again after it was closed. Needs no room on disk if the file is whole.
  void open();
  /// Records that this process was stopped properly. Needs no room on disk.
  void close();

 private:
  void read();
  bool read_records(std::span<const std::byte> file, std::size_t from);
  const Entry* find(const std::string& key) const;
  void apply(Entry entry, bool is_erased);
  enum class Appended : std::uint8_t { all, nothing, unknown };
  Appended append(std::span<const std::byte> records, std::uint64_t count, Sync sync);
  bool count_records(std::uint64_t records, std::uint64_t bytes, Sync sync);
  void write(std::span<const std::byte> records, std::uint64_t count, Sync sync);
  void read_slots(std::span<const std::byte> file);
  void mark(bool is_closed);
  void fail_for_memory();
  bool rewrite();
  std::unique_ptr<Disk> disk_;
  std::string name_;
  std::list<Entry> entries_;
  std::unordered_map<std::string_view, std::list<Entry>::iterator> places_;  // in entries_, by their keys there
  std::uint64_t live_bytes_ = 0;                                             // of a file with exactly these entries
  std::uint64_t file_bytes_ = 0;                                             // these two: what is certainly in the file
  std::uint64_t file_records_ = 0;
  std::uint64_t slot_number_ = 0;   // of the newest slot
  bool has_file_ = false;           // a file that may be appended to
  std::vector<std::byte> waiting_;  // records that found no room on disk
  std::uint64_t waiting_records_ = 0;
  Left left_ = Left::none;
  bool may_have_lost_ = false;
  bool is_worth_keeping_ = false;  // the damaged file, which the next one replaces
  std::string damage_;
  std::string other_layout_;
  std::string problem_;
};

}  // namespace collided::engine::service
