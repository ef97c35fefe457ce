#include "client/cli/output/terminal_width.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <charconv>
#include <string>

namespace collided::cli {

std::size_t terminal_width(const Io& io) {
  const std::string asked = io.env("COLUMNS");
  std::size_t columns = 0;
  if (std::from_chars(asked.data(), asked.data() + asked.size(), columns).ec == std::errc() && columns > 0)
    return columns;
  if (!io.out_is_terminal) return 0;
  constexpr std::size_t kUsual = 80;
  winsize size{};
  const bool known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : kUsual;
}

}  // namespace collided::cli
