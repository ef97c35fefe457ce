#include "client/cli/output/progress.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"

namespace collided::cli {

Progress::Progress(Io& io, const Globals& globals) : io_(io), wanted_(io.err_is_terminal && !globals.quiet) {}

void Progress::show(std::uint64_t done, std::string_view what, double fraction) {
  const Clock::time_point now = Clock::now();
  if (!wanted_ || now < next_) return;
  next_ = now + std::chrono::milliseconds(100);
  shown_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  std::string line = done > 0
                         ? fmt::format(" {} {}  {} /s", format_count(done), what,
                                       format_count(static_cast<std::uint64_t>(static_cast<double>(done) / seconds)))
                         : fmt::format(" {}", what);
  if (fraction > 0) {
    constexpr std::size_t kBarWidth = 24;
    const auto filled = static_cast<std::size_t>(std::clamp(fraction, 0.0, 1.0) * kBarWidth);
    const double left_s = seconds * (1 - fraction) / fraction;
    line += fmt::format("  [{}{}] {:.0f} %  {:.0f} s left", std::string(filled, '='),
                        std::string(kBarWidth - filled, ' '), fraction * 100, left_s);
  }
  io_.err << '\r' << line << "\x1b[K" << std::flush;
}

void Progress::clear() {
  if (!shown_) return;
  shown_ = false;
  io_.err << "\r\x1b[K" << std::flush;
}

}  // namespace collided::cli
