#pragma once

#include <string>
#include <string_view>

namespace collided::view {

/// A file for data too large for memory. It has no name in any folder, so it disappears with its owner, also after a
/// crash.
class UploadedFile {
 public:
  /// Makes an empty file in the folder for temporary files. Throws std::system_error if that is impossible.
  UploadedFile();
  ~UploadedFile();
  UploadedFile(const UploadedFile&) = delete;
  UploadedFile& operator=(const UploadedFile&) = delete;

  /// Throws std::system_error if the bytes cannot be written, such as on a full disk.
  void append(std::string_view bytes);
  /// A path by which this process can open the file.
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

}  // namespace collided::view
