#pragma once

#include <chrono>
#include <cstdint>
#include <string_view>

#include "client/cli/session.hpp"

namespace collided::cli {

/// A line of progress on standard error that is overwritten in place: only on a terminal, after 400 ms, and at most ten
/// times a second. The destructor erases it. One thread.
class Progress {
 public:
  Progress(Io& io, const Globals& globals);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows a count of completed work.
  /// fraction  of the whole, in [0, 1]; below 0: unknown
  void show(std::uint64_t done, std::string_view what, double fraction = -1);
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  Io& io_;
  bool wanted_;
  bool shown_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_ = start_ + std::chrono::milliseconds(400);
};

}  // namespace collided::cli
