#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace collided::engine {

/// A file that is written piece by piece, and gets its name only once it is complete and on the disk. It is first
/// written beside the path; the destructor removes it if unfinished.
///
/// threads  one at a time
class FileReplacement {
 public:
  explicit FileReplacement(const std::string& path);
  ~FileReplacement();
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;

  /// Each returns the error; empty: done. After a failure they do nothing.
  std::string append(std::span<const std::byte> bytes);
  std::string put_in_place();

 private:
  std::string path_;
  std::string beside_;
  std::string failure_;
  int file_ = -1;
};

/// Replaces the file at the path, or creates it, completely or not at all: the new file is written beside it, synced to
/// the disk and renamed.
///
/// pieces    the bytes, one after the other
/// returns   the error; empty: done
std::string replace_file(const std::string& path, std::span<const std::span<const std::byte>> pieces);

/// Writes to an open file from its current position, and syncs it to the disk. Returns as replace_file.
std::string write_file(int file, std::span<const std::span<const std::byte>> pieces);

}  // namespace collided::engine
