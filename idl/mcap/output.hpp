#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace collided::mcap {

/// Where a file's bytes go: all of a piece or nothing of it.
class Output {
 public:
  virtual ~Output() = default;
  /// False: nothing of it was kept; problem() says why.
  [[nodiscard]] virtual bool append(std::span<const std::byte> bytes) = 0;
  virtual const std::string& problem() const = 0;
};

/// A file on disk that holds whole pieces at any time: one that did not fit is cut off again.
/// One thread.
class FileOutput : public Output {
 public:
  /// Makes the file or empties it; throws std::runtime_error with the path and the reason.
  explicit FileOutput(const std::string& path);
  ~FileOutput() override;
  FileOutput(const FileOutput&) = delete;
  FileOutput& operator=(const FileOutput&) = delete;

  bool append(std::span<const std::byte> bytes) override;
  const std::string& problem() const override { return problem_; }
  std::uint64_t size() const { return size_; }

 private:
  std::string path_;
  std::string problem_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace collided::mcap
