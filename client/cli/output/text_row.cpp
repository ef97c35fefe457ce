#include "client/cli/output/text_row.hpp"

#include "client/cli/failure.hpp"

namespace collided::cli {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

void trim(std::string& text) {
  while (!text.empty() && is_blank(text.back())) text.pop_back();
  std::size_t begin = 0;
  while (begin < text.size() && is_blank(text[begin])) ++begin;
  text.erase(0, begin);
}

void split_at_blanks(std::string_view line, std::vector<std::string>& cells) {
  std::size_t at = 0;
  while (at < line.size()) {
    while (at < line.size() && is_blank(line[at])) ++at;
    const std::size_t begin = at;
    while (at < line.size() && !is_blank(line[at])) ++at;
    if (at > begin) cells.emplace_back(line.substr(begin, at - begin));
  }
}

}  // namespace

char sniff_separator(std::string_view line) {
  for (const char separator : {',', ';', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

void split_cells(std::string_view line, char separator, std::vector<std::string>& cells) {
  cells.clear();
  if (separator == ' ') {
    split_at_blanks(line, cells);
    return;
  }
  std::string cell;
  bool quoted = false;
  bool was_quoted = false;
  for (std::size_t at = 0; at < line.size(); ++at) {
    const char c = line[at];
    if (quoted && c == '"' && at + 1 < line.size() && line[at + 1] == '"') {
      cell += '"';
      ++at;
    } else if (c == '"' && (quoted || cell.empty())) {
      quoted = !quoted;
      was_quoted = true;
    } else if (c == separator && !quoted) {
      if (!was_quoted) trim(cell);
      cells.push_back(std::move(cell));
      cell.clear();
      was_quoted = false;
    } else {
      cell += c;
    }
  }
  if (quoted) throw bad_use("a quote (\") is never closed");
  if (!was_quoted) trim(cell);
  cells.push_back(std::move(cell));
}

bool is_blank_line(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first == std::string_view::npos || line[first] == '#';
}

}  // namespace collided::cli
