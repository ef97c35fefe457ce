#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace collided::engine::files {

/// One line on stderr that shows the progress of a long task: only on a terminal, and only after 400 ms; the destructor
/// erases it.
class ProgressLine {
 public:
  explicit ProgressLine(std::string task);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Shows the progress, at most ten times a second.
  ///
  /// fraction  done, in [0, 1]
  /// threads   any
  void tell(double fraction);

 private:
  using Clock = std::chrono::steady_clock;

  std::mutex mutex_;
  std::string task_;
  bool on_terminal_;
  bool is_shown_ = false;
  Clock::time_point begun_ = Clock::now();
  Clock::time_point reported_ = begun_;
};

}  // namespace collided::engine::files
