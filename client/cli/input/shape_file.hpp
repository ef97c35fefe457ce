#pragma once

#include <string>
#include <vector>

#include <collided/client.hpp>

namespace collided::cli {

/// Reads a shape from the words points FILE R | polyline FILE R | heights FILE DX [DY]. The file has rows of numbers
/// separated by blanks or commas, and comments after '#'; "-" is the descriptor `in`. Throws Failure with the line.
ShapePart read_shape(const std::vector<std::string>& words, int in);

/// Whether this kind of shape is read from a file.
bool is_file_kind(const std::string& kind);

}  // namespace collided::cli
