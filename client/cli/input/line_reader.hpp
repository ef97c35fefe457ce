#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace collided::cli {

/// Reads lines from a file descriptor. The caller can test whether reading would wait, so that a pipe that pauses does
/// not delay the answers to earlier lines. A line longer than kLongestLine is cut; see line_was_cut(). One thread.
class LineReader {
 public:
  static constexpr std::size_t kLongestLine = 1 << 20;

  explicit LineReader(int file) : file_(file), buffer_(kBufferBytes) {}

  /// Reads the next line, without its line end. False at the end of input or when interrupted. May wait.
  bool next(std::string& line);
  /// Sets a function that next() calls about ten times a second while it waits.
  void when_waiting(std::function<void()> call) { while_waiting_ = std::move(call); }
  /// Whether next() would return at once.
  bool ready();
  /// Number of the last line that was read, from 1.
  std::size_t line_number() const { return line_number_; }
  bool line_was_cut() const { return cut_; }
  bool failed() const { return failed_; }

 private:
  static constexpr std::size_t kBufferBytes = 1 << 18;
  bool fill(int wait_ms);
  const char* line_end() const;

  int file_;
  std::function<void()> while_waiting_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::size_t line_number_ = 0;
  bool ended_ = false;
  bool failed_ = false;
  bool cut_ = false;
};

/// The source of the lines of `collide -` and `collide shell`.
struct LineSource {
  std::function<bool(std::string& line)> next;  // false at the end; may wait
  std::function<std::size_t()> number = {};     // of the last line, for errors; none at a prompt
};

/// A file opened for reading, or the descriptor `in` for "-". Throws Failure with the reason.
class InputFile {
 public:
  InputFile(const std::string& path, int in);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  int descriptor() const { return file_; }
  /// Its name for messages: "rays.csv", or "stdin".
  const std::string& name() const { return name_; }

 private:
  int file_;
  bool owned_;
  std::string name_;
};

}  // namespace collided::cli
