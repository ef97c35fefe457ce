#pragma once

#include "server/programs/files/file_options.hpp"

namespace collided::engine::files {

/// Prints the file's triangles on standard output, for a program that adds them as one shape: lines "v X Y Z", then
/// lines "t A B C" with numbers of vertices from 0. Reports the rest of the file on standard error. Returns the exit
/// code. Throws LoadError.
int triangles(const FileOptions& file);

}  // namespace collided::engine::files
