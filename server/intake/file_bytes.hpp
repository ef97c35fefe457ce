#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// Throws the LoadError for a file that cannot be used.
[[noreturn]] void refuse_file(const std::string& name, const std::string& what);

/// The bytes of one file, read-only, for as long as this lives.
class FileBytes {
 public:
  enum class Access { copied, copied_as_asked, mapped, mapped_as_read };

  /// access  copied: later changes of the file have no effect
  /// copied_as_asked: only the bytes for which fetch_before() was called can be read; if the file changes meanwhile,
  /// that call may throw, and nothing worse happens
  /// mapped: no copy, for files that are only ever replaced by rename, like those of save_scene; if such a file were
  /// truncated in place, reading it would end the process
  /// mapped_as_read: mapped too, but only what is read comes into memory, and the file may have any size
  /// throws  LoadError if the path is not a regular file, cannot be read, or is larger than options.max_file_bytes
  FileBytes(const std::string& path, Access access, const LoadOptions& options);
  ~FileBytes();
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  std::span<const char> bytes() const { return {data_, byte_count_}; }

  /// Copies the bytes before `byte` that are not copied yet. Those from `byte` on must not be read.
  /// throws    LoadError if the file has become shorter or cannot be read
  void fetch_before(std::size_t byte);

  /// Returns to the system the memory of a mapped file's whole pages before `byte`; they must not be read any more.
  void forget_before(std::size_t byte);

  /// Returns to the system the memory of the whole pages inside a piece of a copy, or of a file mapped as it is read;
  /// they must not be read any more.
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
  OpenFile file_;  // open until all of it is copied
  std::size_t fetched_bytes_ = 0;
  std::unique_ptr<char[], Unmap> copy_;  // mapped, not allocated: pages can be returned once they are read
  void* map_ = nullptr;                  // map of the file
  bool may_drop_pages_ = false;          // from the map, one by one
  const char* data_ = nullptr;
  std::size_t byte_count_ = 0;
  std::size_t forgotten_bytes_ = 0;
};

/// The last component of a path, as used in messages.
std::string file_name(const std::string& path);

}  // namespace collided::engine
