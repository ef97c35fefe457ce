#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

// Text that fits a terminal. Widths are columns; 0 stands for no limit.
namespace collided::cli {

/// The columns that a text takes on a terminal: one for each UTF-8 character, none for colour codes.
std::size_t columns_of(std::string_view text);

/// The text broken into lines of at most `width` columns, at double blanks where there are any, else at single ones.
/// Lines after the first are indented. A word that is longer than a line is not broken.
std::string wrapped(std::string_view text, std::size_t width);

/// Narrows the widest columns of a table until it fits, with two blanks between columns. No column becomes narrower
/// than a few letters.
void fit(std::vector<std::size_t>& widths, std::size_t width);

/// The text if it fits, else "…" and its end, since the end of a name tells more than its beginning.
std::string cut_to(std::string_view text, std::size_t width);

}  // namespace collided::cli
