#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// The bytes of one file, read-only, for as long as this lives.
class FileBytes {
 public:
  enum class Access { copied, copied_as_asked, mapped };

  /// access   copied: nothing that happens to the file once this is made matters. copied_as_asked: only what fetch() has asked
  ///          for is there, and nothing that happens to the file does more than make it throw. mapped: no copy, for files that
  ///          are only ever replaced by rename, as save_scene does; one that is cut short in place would end the process.
  /// throws   LoadError for what is not a regular file, is unreadable or larger than options.max_file_bytes
  FileBytes(const std::string& path, Access access, const LoadOptions& options);
  ~FileBytes();
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  std::span<const char> bytes() const { return {data_, byte_count_}; }

  /// Copies the bytes before that one that are not there yet; those beyond must not be read.
  /// throws    LoadError where the file has become shorter or cannot be read
  void fetch_before(std::size_t byte);

  /// Gives the whole pages of a mapped file before that byte back; they must not be read any more.
  void forget_before(std::size_t byte);

  /// Gives the whole pages inside a piece of a copy back; they must not be read any more.
  /// threads   any, for pieces that do not overlap
  void give_back(std::span<const char> piece) const;

 private:
  void reserve();
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
  std::unique_ptr<char[], Unmap> copy_;  // mapped rather than allocated, so that pages can go as soon as they are read
  void* map_ = nullptr;                  // of the file
  const char* data_ = nullptr;
  std::size_t byte_count_ = 0;
  std::size_t forgotten_bytes_ = 0;
};

/// The last component of a path, as messages call a file.
std::string file_name(const std::string& path);

}  // namespace collided::engine
