#pragma once

#include <cstddef>

#include "client/cli/io.hpp"

namespace collided::cli {

/// Columns of the terminal on standard output: COLUMNS if it is set, else what the terminal reports, else 80. 0 if
/// output is not a terminal and COLUMNS is not set: then nothing is wrapped.
std::size_t terminal_width(const Io& io);

/// Its rows: LINES if it is set, else what the terminal reports, else 24.
std::size_t terminal_height(const Io& io);

}  // namespace collided::cli
