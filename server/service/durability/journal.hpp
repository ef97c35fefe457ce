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
};
/// The files of a folder that is there.
std::unique_ptr<Disk> disk_in(const std::string& folder);

/// A log of what must outlive a crash: named entries, of which the last one of a name counts. Records are appended to a
/// file, each with its length and checksum. How many there are is written at the file's beginning once they are synced,
/// so that a lost end is noticed (journal_layout.hpp). Once most of the file is stale it is rewritten beside itself,
/// synced and renamed over the old one. A write, sync or rename that failed makes the file a failed one: nothing is
/// appended to it any more, the next entry goes to a new file with all that is live, and until that has worked
/// problem() says so.
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

  /// Reads what an earlier process left. A record that is cut or does not match its checksum ends the reading: what
  /// comes before it is kept, and damage() says what was lost. damage() also says so where fewer records are there than
  /// were acknowledged.
  Journal(std::unique_ptr<Disk> disk, std::string name);

  /// The live entries, in the order in which their names were first written.
  const std::vector<Entry>& entries() const { return entries_; }
  /// What was found damaged, as a sentence; empty: nothing.
  const std::string& damage() const { return damage_; }
  /// Why not everything that was put is on the disk; empty: all is.
  const std::string& problem() const { return problem_; }

  /// Adds an entry or replaces the one of its key. With Sync::now it is on the disk on return, unless problem() says
  /// why not.
  void put(Entry entry, Sync sync);
  /// Removes the entries of these keys; unknown keys are ignored.
  void erase(std::span<const std::string> keys, Sync sync);
  /// Removes all entries, and forgets damage().
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
  std::uint64_t file_bytes_ = 0;  // these two: what is in the file for certain
  std::uint64_t file_records_ = 0;
  std::uint64_t slot_number_ = 0;  // of the newest slot
  bool has_file_ = false;          // a file that may be appended to
  std::string damage_;
  std::string problem_;
};

}  // namespace collided::engine::service
