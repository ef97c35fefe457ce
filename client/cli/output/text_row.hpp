#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace collided::cli {

/// What stands between the cells of a line: a comma, a semicolon, a tab, or blanks.
char sniff_separator(std::string_view line);

/// Cells of a CSV line; with blanks as separator several count as one. A cell in double quotes may hold the separator,
/// and "" is a quote in it. Throws Failure on an open quote.
void split_cells(std::string_view line, char separator, std::vector<std::string>& cells);

/// True for lines that hold no data: empty, blanks, or a comment after '#'.
bool is_blank_line(std::string_view line);

}  // namespace collided::cli
