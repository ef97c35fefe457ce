#pragma once

#include <cstddef>

#include "client/cli/io.hpp"

namespace collided::cli {

/// Columns of the terminal on standard output: COLUMNS where it is set, else what the terminal says, else 80. 0 where
/// output is not a terminal and COLUMNS is not set: then nothing is wrapped.
std::size_t terminal_width(const Io& io);

/// Its rows: LINES where it is set, else what the terminal says, else 24.
std::size_t terminal_height(const Io& io);

}  // namespace collided::cli
