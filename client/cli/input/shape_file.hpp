#pragma once

#include <string>
#include <vector>

#include <collided/client.hpp>

namespace collided::cli {

/// points FILE R | polyline FILE R | heights FILE DX [DY]: words from the kind on. Rows of numbers, apart by blanks or
/// commas; "-" is `in`; '#' begins a comment. Throws Failure naming the line.
ShapePart read_shape(const std::vector<std::string>& words, int in);

/// Whether the kind takes a file.
bool is_file_kind(const std::string& kind);

}  // namespace collided::cli
