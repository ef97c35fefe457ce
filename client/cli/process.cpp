#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <iostream>

#include "client/cli/run.hpp"

namespace collided::cli {
namespace {

extern "C" void on_interrupt(int signal_number) {
  // A second Ctrl-C ends a program that hangs.
  if (stop_requested.exchange(true)) std::_Exit(128 + signal_number);
}

void install_signals() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // `collide watch | head` ends without a message when the next write fails.
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace

int run_process(int argument_count, char** arguments, const OwnParts& own) {
  std::ios::sync_with_stdio(false);
  std::cin.tie(nullptr);
  install_signals();
  Io io{.in = STDIN_FILENO,
        .out = std::cout,
        .err = std::cerr,
        .out_is_terminal = ::isatty(STDOUT_FILENO) == 1,
        .err_is_terminal = ::isatty(STDERR_FILENO) == 1,
        .environment = [](const char* name) -> const char* { return std::getenv(name); }};
  return run({arguments + 1, arguments + argument_count}, io, own);
}

}  // namespace collided::cli
