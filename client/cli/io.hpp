#pragma once

#include <atomic>
#include <functional>
#include <ostream>
#include <string>

namespace collided::cli {

/// The streams of a command line; tests use strings and pipes.
struct Io {
  int in = 0;  // file descriptor of standard input
  std::ostream& out;
  std::ostream& err;
  bool out_is_terminal = false;
  bool err_is_terminal = false;
  std::function<const char*(const char*)> environment;  // returns a variable's value or null, as getenv does

  /// The value of a variable; empty if it is not set.
  std::string env(const char* name) const {
    const char* value = environment ? environment(name) : nullptr;
    return value == nullptr ? std::string() : std::string(value);
  }
};

/// Set by SIGINT and SIGTERM. Every loop checks it and ends.
inline std::atomic<bool> stop_requested{false};

}  // namespace collided::cli
