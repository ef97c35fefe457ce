#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// Throws the LoadError that a file which cannot be used ends in.
[[noreturn]] void refuse_file(const std::string& name, const std::string& what);

/// The bytes of one file, read-only, for as long as this lives.
class FileBytes {
 public:
  enum class Access { copied, copied_as_asked, mapped, mapped_as_read };

  /// access  copied: what happens to the file afterwards has no effect
  ///         copied_as_asked: only the bytes that fetch_before() was called for can be read; where the file changes
  ///         meanwhile, that call may throw, and nothing worse happens
  ///         mapped: no copy, for files that are only ever replaced by rename, as save_scene does; if such a file were
  ///         cut short in place, reading it would end the process
  ///         mapped_as_read: likewise, of which only what is read comes into memory; it may have any size
  /// throws  LoadError where the path is not a regular file, cannot be read, or is larger than options.max_file_bytes
  FileBytes(const std::string& path, Access access, const LoadOptions& options);
  ~FileBytes();
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  std::span<const char> bytes() const { return {data_, byte_count_}; }

  /// Copies the bytes before `byte` that are not there yet. Those from `byte` on must not be read.
  /// throws    LoadError where the file has become shorter or cannot be read
  void fetch_before(std::size_t byte);

  /// Returns to the system the memory of a mapped file's whole pages before `byte`; they must not be read any more.
  void forget_before(std::size_t byte);

  /// Returns to the system the memory of the whole pages inside a piece of a copy, or of a file that is mapped as it is
  /// read; they must not be read any more.
  /// threads   any, for pieces that do not overlap
  void give_back(std::span<const char> piece) const;

 private:
  void reserve();
  void map(bool at_once);
  void copy_all(const LoadOptions& options);

  struct Unmap {
    std::size_t byte_count;
    void operator()(char* memory) const;
  };
  struct OpenFile {
    int number = -1;
    void close();
    ~OpenFile() { close(); }
  };

  std::string name_;
  OpenFile file_;  // until all of it is copied
  std::size_t fetched_bytes_ = 0;
  std::unique_ptr<char[], Unmap> copy_;  // mapped, not allocated: pages can be returned once they are read
  void* map_ = nullptr;                  // of the file
  bool may_drop_pages_ = false;          // of the map, one by one
  const char* data_ = nullptr;
  std::size_t byte_count_ = 0;
  std::size_t forgotten_bytes_ = 0;
};

/// The last component of a path, as messages call a file.
std::string file_name(const std::string& path);

}  // namespace collided::engine
