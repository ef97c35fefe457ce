#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

// Text that fits a terminal. Widths are columns; 0 stands for no limit.
namespace collided::cli {

/// The columns that a text takes on a terminal: one for each UTF-8 character, none for colour codes.
std::size_t columns_of(std::string_view text);

/// The text broken into lines of at most `width` columns, at double blanks if there are any, else at single ones; a
/// number stays with its unit, and the numbers of a point together, if they fit. Lines after the first are indented. A
/// word that is longer than a line is not broken.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent = 5);

/// Whether one of the text's words is a number, with its sign and unit: part of such a text reads as another number, so
/// it is never cut.
bool holds_number(std::string_view text);

/// A column of a table.
struct ColumnWidth {
  std::size_t columns = 0;
  bool may_shrink = true;
};

/// Narrows the widest narrowable columns of a table until it fits, with `gap` blanks between columns. No column becomes
/// narrower than 16 letters, so short words and headings stay whole. Returns false if it still does not fit.
bool fit(std::vector<ColumnWidth>& widths, std::size_t width, std::size_t gap = 2);

/// The text if it fits, else its beginning and its end with "…" between them: a name begins with its scene and ends
/// with what distinguishes it.
std::string cut_to(std::string_view text, std::size_t width);

}  // namespace collided::cli
