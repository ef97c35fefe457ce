#pragma once

#include <string>
#include <string_view>

namespace collided::view {

/// A file for what is too large to be kept in memory. It has no name in any folder, so it is gone when its owner is,
/// also after a crash.
class UploadedFile {
 public:
  /// Makes an empty file in the folder for temporary files. Throws std::system_error where that cannot be.
  UploadedFile();
  ~UploadedFile();
  UploadedFile(const UploadedFile&) = delete;
  UploadedFile& operator=(const UploadedFile&) = delete;

  /// Throws std::system_error where the bytes cannot be written, such as on a full disk.
  void append(std::string_view bytes);
  /// Leads this process to the file.
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

}  // namespace collided::view
