#pragma once

#include "server/programs/files/file_options.hpp"

namespace collided::engine::files {

/// Prints the centres of the file's balls on standard output, one a line as "X Y Z": the points of a cloud. Reports the
/// rest of the file on standard error. Returns the exit code. Throws LoadError.
int points(const FileOptions& file);

}  // namespace collided::engine::files
