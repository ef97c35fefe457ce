#include "client/cli/output/terminal_width.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <charconv>
#include <string>

namespace collided::cli {

namespace {

/// A number above 0 in a variable; 0 if there is none.
std::size_t number_in(const Io& io, const char* variable) {
  const std::string asked = io.env(variable);
  std::size_t number = 0;
  return std::from_chars(asked.data(), asked.data() + asked.size(), number).ec == std::errc() ? number : 0;
}

winsize terminal_size() {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) size = {};
  return size;
}

}  // namespace

std::size_t terminal_width(const Io& io) {
  if (const std::size_t columns = number_in(io, "COLUMNS")) return columns;
  if (!io.out_is_terminal) return 0;
  constexpr std::size_t kUsual = 80;
  const winsize size = terminal_size();
  return size.ws_col > 0 ? size.ws_col : kUsual;
}

std::size_t terminal_height(const Io& io) {
  if (const std::size_t rows = number_in(io, "LINES")) return rows;
  constexpr std::size_t kUsual = 24;
  const winsize size = terminal_size();
  return size.ws_row > 0 ? size.ws_row : kUsual;
}

}  // namespace collided::cli
