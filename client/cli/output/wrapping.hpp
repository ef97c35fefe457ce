#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

// Text that fits a terminal. Widths are columns; 0 stands for no limit.
namespace collided::cli {

/// Columns that a text takes: colours and the later bytes of a character of UTF-8 take none.
std::size_t columns_of(std::string_view text);

/// The text broken into lines of at most `width` columns, at two blanks where there are any, else at one; the lines after
/// the first are indented. A word that is longer stays whole.
std::string wrapped(std::string_view text, std::size_t width);

/// Narrows the widest columns of a table, two blanks apart, until it fits; none gets narrower than a few letters.
void fit(std::vector<std::size_t>& widths, std::size_t width);

/// The text if it fits, else its end after "…": the end of a name tells more than its beginning.
std::string cut_to(std::string_view text, std::size_t width);

}  // namespace collided::cli
