#include "client/cli/input/keys.hpp"

#include <poll.h>
#include <unistd.h>

namespace collided::cli {

Keys::Keys(int file) : file_(file) {
  // Only in the foreground: a process that changes the terminal from the background is stopped.
  is_terminal_ = ::tcgetattr(file, &before_) == 0 && ::tcgetpgrp(file) == ::getpgrp();
  if (!is_terminal_) return;
  termios single = before_;
  // Keys arrive at once and are not echoed; Ctrl-C stays a signal.
  single.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  single.c_cc[VMIN] = 0;
  single.c_cc[VTIME] = 0;
  ::tcsetattr(file_, TCSANOW, &single);
}

Keys::~Keys() {
  if (is_terminal_) ::tcsetattr(file_, TCSANOW, &before_);
}

std::optional<char> Keys::next() {
  if (!is_terminal_) return std::nullopt;
  pollfd readable{.fd = file_, .events = POLLIN, .revents = 0};
  char key = 0;
  if (::poll(&readable, 1, 0) != 1 || ::read(file_, &key, 1) != 1) return std::nullopt;
  return key;
}

}  // namespace collided::cli
