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
  /// All bytes of a file; nothing where it cannot be read.
  virtual std::optional<std::vector<std::byte>> read(const std::string& name) = 0;
  /// Makes an empty file in place of whatever is there.
  virtual bool create(const std::string& name) = 0;
  /// Adds to the end of a file that is there.
  virtual bool append(const std::string& name, std::span<const std::byte> bytes) = 0;
  /// Replaces as many bytes that are there, from byte `at` on.
  virtual bool overwrite(const std::string& name, std::uint64_t at, std::span<const std::byte> bytes) = 0;
  /// Leaves only the first `bytes` bytes of the file.
  virtual bool cut(const std::string& name, std::uint64_t bytes) = 0;
  /// From then on what was written outlives a loss of power.
  virtual bool sync(const std::string& name) = 0;
  /// Puts a file in the place of another; from then on this outlives a loss of power.
  virtual bool rename(const std::string& from, const std::string& to) = 0;
  /// Takes a file away; one that is not there is as good as taken away.
  virtual bool remove(const std::string& name) = 0;
  /// Gives the file a second name, in place of whatever has it.
  virtual bool link(const std::string& name, const std::string& second) = 0;
  /// Takes room for so many bytes after the file's end, which appending then uses up.
  virtual bool reserve(const std::string& name, std::uint64_t bytes) = 0;
};
/// The files of a folder that is there.
std::unique_ptr<Disk> disk_in(const std::string& folder);

/// A log of what must outlive a crash: named entries, of which the last one of a name counts. Records are appended to a
/// file, each with its length and checksum. How many there are is written at the file's beginning once they are synced,
/// so that a lost end is noticed (journal_layout.hpp). Once most of the file is stale it is rewritten beside itself,
/// synced and renamed over the old one. What finds no room on the disk waits in memory and goes with the next entry;
/// after any other failure the file is given up: the next entry starts a new file with all that is live, and problem()
/// tells of the failure until that has worked. A damaged file keeps a second name, NAME.damaged,
/// when it is replaced.
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
  enum class Sync : std::uint8_t { now, later };  // later: outlives this process but no loss of power
  /// How the process before this one left its file. unknown: the file is damaged.
  enum class Left : std::uint8_t { none, unknown, open, closed };

  /// Reads what an earlier process left. A record that is cut or does not match its checksum ends the reading: what
  /// comes before it is kept, and damage() says what was lost. damage() also says so where fewer records are there than
  /// were acknowledged.
  Journal(std::unique_ptr<Disk> disk, std::string name);

  /// The live entries, in the order in which their names were first written.
  const std::list<Entry>& entries() const { return entries_; }
  /// What was found damaged, as a sentence; empty: nothing.
  const std::string& damage() const { return damage_; }
  /// Whether what was acknowledged may be missing from entries(): damage() says how much.
  bool may_have_lost() const { return may_have_lost_; }
  Left left() const { return left_; }
  /// The number of the file's layout if another version of this program wrote it; then nothing of it was read, and it
  /// stays as it is until the first change. Empty: it did not.
  const std::string& other_layout() const { return other_layout_; }
  /// Why not everything that was put is on the disk; empty: all is.
  const std::string& problem() const { return problem_; }

  /// Removes the entries of these keys, of which unknown ones are ignored, then adds entries or replaces those of their
  /// keys. With Sync::now all is on the disk on return, unless problem() says why not.
  void change(std::span<const std::string> erased, std::span<const Entry> put, Sync sync);
  void put(const Entry& entry, Sync sync) { change({}, std::span(&entry, 1), sync); }
  void erase(std::span<const std::string> keys, Sync sync) { change(keys, {}, sync); }
  /// Whether records of so many bytes, and some more, will find room; makes a file where there is none yet.
  bool has_room(std::uint64_t bytes);
  /// Removes all entries, and forgets damage(). The file counts as open again.
  void clear();
  /// Writes down that a process uses the file again after it was closed. Needs no room on the disk if the file is whole.
  void open();
  /// Writes down that this process ends in order. Needs no room on the disk.
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
  std::uint64_t live_bytes_ = 0;  // of the file, if it held these entries and nothing else
  std::uint64_t file_bytes_ = 0;  // these two: what is in the file for certain
  std::uint64_t file_records_ = 0;
  std::uint64_t slot_number_ = 0;   // of the newest slot
  bool has_file_ = false;           // a file that may be appended to
  std::vector<std::byte> waiting_;  // records that found no room on the disk
  std::uint64_t waiting_records_ = 0;
  Left left_ = Left::none;
  bool may_have_lost_ = false;
  bool is_worth_keeping_ = false;  // the damaged file, which the next one replaces
  std::string damage_;
  std::string other_layout_;
  std::string problem_;
};

}  // namespace collided::engine::service
