#pragma once

#include "client/cli/input/line_reader.hpp"
#include "client/cli/io.hpp"

namespace collided::cli {

/// Lines typed at a prompt, with editing, and with a history that is kept in the user's state folder. For a terminal on
/// standard input. At most one in a process.
LineSource prompted_lines(const Io& io);

}  // namespace collided::cli
