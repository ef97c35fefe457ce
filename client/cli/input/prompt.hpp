#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "client/cli/io.hpp"

namespace collided::cli {

/// Where the lines of `collide -` and `collide shell` come from.
struct LineSource {
  std::function<bool(std::string& line)> next;  // false at the end; may wait
  std::function<std::size_t()> number = {};     // of the last line, for errors; none where a person types
};

/// Lines that a person types at a prompt, with editing, and with a history that is kept in the user's state folder. For
/// a terminal on standard input. One at a time in a process.
LineSource prompted_lines(const Io& io);

}  // namespace collided::cli
