#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace collided::cli {

/// The separator of a line's cells: a comma, a semicolon, a tab, or a blank.
char sniff_separator(std::string_view line);

/// Splits a line into cells. Several blanks count as one separator. A cell in double quotes may contain the separator,
/// and "" for a quote. Throws Failure for an open quote.
void split_cells(std::string_view line, char separator, std::vector<std::string>& cells);

/// Whether a line has no data: it is empty, blank, or a comment after '#'.
bool is_blank_line(std::string_view line);

}  // namespace collided::cli
