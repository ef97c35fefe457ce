#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace collided::engine {

/// An unnamed file beside the one that is being made, for data that does not fit into memory. It vanishes with the
/// process.
///
/// throws  LoadError that names the file being made: the disk is full, or cannot be read any more
class ScratchFile {
 public:
  /// beside  the path of the file being made
  explicit ScratchFile(const std::string& beside);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  void write(std::uint64_t first_byte, std::span<const std::byte> bytes);
  /// All bytes must have been written.
  void read(std::uint64_t first_byte, std::span<std::byte> bytes) const;

 private:
  [[noreturn]] void fail(const char* what) const;

  std::string beside_;
  int number_ = -1;
};

}  // namespace collided::engine
