#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace collided::mcap {

/// Writes a file piece by piece: each piece completely or not at all.
class Output {
 public:
  virtual ~Output() = default;
  /// Appends a piece. False: nothing of it was written, and problem() is the reason.
  [[nodiscard]] virtual bool append(std::span<const std::byte> bytes) = 0;
  /// Why a piece was refused; empty: none was.
  virtual const std::string& problem() const = 0;
};

/// A file on disk that always holds whole pieces only: an incomplete piece is cut off.
///
/// threads  one
class FileOutput : public Output {
 public:
  /// Creates the file, or empties it. Throws std::runtime_error with the path and the reason.
  explicit FileOutput(const std::string& path);
  ~FileOutput() override;
  FileOutput(const FileOutput&) = delete;
  FileOutput& operator=(const FileOutput&) = delete;

  bool append(std::span<const std::byte> bytes) override;
  const std::string& problem() const override { return problem_; }
  /// Bytes of the whole pieces in the file.
  std::uint64_t size() const { return size_; }

 private:
  std::string path_;
  std::string problem_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace collided::mcap
