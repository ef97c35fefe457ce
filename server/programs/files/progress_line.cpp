#include "server/programs/files/progress_line.hpp"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace collided::engine::files {

using namespace std::chrono_literals;

ProgressLine::ProgressLine(std::string task) : task_(std::move(task)), on_terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (is_shown_) std::fputs("\r\x1b[K", stderr);
}

void ProgressLine::tell(double fraction) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (!on_terminal_ || now - begun_ < 400ms || now - reported_ < 100ms) return;
  reported_ = now;
  is_shown_ = true;
  const double spent_s = std::chrono::duration<double>(now - begun_).count();
  const double left_s = fraction > 0 ? spent_s / fraction - spent_s : 0;
  std::fprintf(stderr, "\r  %s %3.0f %%, %.0f s left\x1b[K", task_.c_str(), 100 * fraction, left_s);
}

}  // namespace collided::engine::files
