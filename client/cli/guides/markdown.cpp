#include "client/cli/guides/markdown.hpp"

#include <algorithm>
#include <cctype>

#include "client/cli/output/wrapping.hpp"

namespace collided::cli {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// The cells between the bars; a bar within code is a letter.
std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells;
  std::string cell;
  bool is_code = false;
  for (const char c : line.substr(1)) {
    is_code ^= c == '`';
    if (c == '|' && !is_code) cells.emplace_back(trimmed(cell)), cell.clear();
    else cell += c;
  }
  return cells;
}

bool is_rule(std::string_view line) { return line.find_first_not_of("|-: ") == std::string_view::npos; }

/// The marker of an item, "-" or "2."; empty for any other line.
std::string_view item_marker(std::string_view line) {
  if (line.starts_with("- ")) return line.substr(0, 1);
  std::size_t digits = 0;
  while (digits < line.size() && std::isdigit(static_cast<unsigned char>(line[digits])) != 0) ++digits;
  return digits > 0 && line.substr(digits).starts_with(". ") ? line.substr(0, digits + 1) : std::string_view();
}

std::string without_tags(std::string_view line) {
  std::string text;
  bool is_tag = false;
  for (const char c : line) {
    is_tag |= c == '<';
    if (!is_tag) text += c;
    is_tag &= c != '>';
  }
  return text;
}

/// Takes the lines of a text one after the other.
class MarkdownReader {
 public:
  std::vector<MarkdownBlock> read(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      take(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    return std::move(blocks_);
  }

 private:
  void take(std::string_view line) {
    if (line.starts_with("```")) {
      is_code_ = !is_code_;
      if (is_code_) begin(MarkdownKind::code);
      is_open_ = false;
    } else if (is_code_) {
      blocks_.back().lines.emplace_back(line);
    } else if (trimmed(line).empty() || line.starts_with("![") || line.starts_with("<!--")) {
      is_open_ = false;
    } else if (line.starts_with("#")) {
      take_heading(line);
    } else if (line.starts_with("|")) {
      take_row(line);
    } else if (const std::string_view marker = item_marker(line); !marker.empty()) {
      begin(MarkdownKind::item).marker = marker;
      blocks_.back().lines.emplace_back(line.substr(marker.size() + 1));
    } else {
      take_text(line.starts_with("<") ? without_tags(line) : std::string(trimmed(line)));
    }
  }

  void take_heading(std::string_view line) {
    MarkdownBlock& heading = begin(MarkdownKind::heading);
    heading.level = line.find_first_not_of('#');
    heading.lines.emplace_back(trimmed(line.substr(heading.level)));
    is_open_ = false;
  }

  void take_row(std::string_view line) {
    if (is_rule(line)) return;
    if (!is_open_ || blocks_.back().kind != MarkdownKind::table) begin(MarkdownKind::table);
    blocks_.back().rows.push_back(cells_of(line));
  }

  void take_text(const std::string& line) {
    if (line.empty()) return;
    if (!is_open_) begin(MarkdownKind::paragraph).lines.emplace_back(line);
    else blocks_.back().lines.back() += " " + line;
  }

  MarkdownBlock& begin(MarkdownKind kind) {
    is_open_ = true;
    return blocks_.emplace_back(MarkdownBlock{.kind = kind});
  }

  std::vector<MarkdownBlock> blocks_;
  bool is_open_ = false;  // the next line goes on with the last block
  bool is_code_ = false;
};

std::vector<std::size_t> column_widths(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const std::vector<std::string>& row : rows) {
    if (widths.size() < row.size()) widths.resize(row.size());
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], columns_of(row[k]));
  }
  return widths;
}

/// One row, its last cell broken into lines below each other.
void add_row(std::vector<std::string>& lines, const std::vector<std::string>& row,
             const std::vector<std::size_t>& widths, std::size_t left) {
  std::string line;
  for (std::size_t k = 0; k + 1 < row.size(); ++k)
    line += row[k] + std::string(widths[k] + 2 - columns_of(row[k]), ' ');
  const std::string indent(columns_of(line), ' ');
  const std::vector<std::string> last = filled(row.empty() ? std::string() : row.back(), left);
  lines.push_back(line + (last.empty() ? std::string() : last.front()));
  for (std::size_t k = 1; k < last.size(); ++k) lines.push_back(indent + last[k]);
}

/// Each row as a paragraph: its first cell, below it the others by the names of their columns.
std::vector<std::string> row_by_row(const std::vector<std::vector<std::string>>& rows, std::size_t width) {
  std::vector<std::string> lines;
  for (std::size_t at = 1; at < rows.size(); ++at) {
    if (!rows[at].empty()) lines.push_back(rows[at].front());
    for (std::size_t k = 1; k < rows[at].size(); ++k) {
      const std::string name = k < rows[0].size() && !rows[0][k].empty() ? rows[0][k] + ": " : std::string();
      for (const std::string& line : filled(name + rows[at][k], width - 4)) lines.push_back("    " + line);
    }
  }
  return lines;
}

}  // namespace

std::vector<MarkdownBlock> markdown_blocks(std::string_view text) { return MarkdownReader().read(text); }

std::vector<MarkdownSpan> markdown_spans(std::string_view text, LinkNote note) {
  std::vector<MarkdownSpan> spans;
  const auto add = [&](std::string_view piece, bool strong) {
    if (!piece.empty()) spans.push_back({std::string(piece), strong});
  };
  std::size_t plain = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view mark = text.substr(at).starts_with("**") ? "**" : text[at] == '`' ? "`" : "";
    if (const std::size_t end = mark.empty() ? std::string_view::npos : text.find(mark, at + mark.size());
        end != std::string_view::npos) {
      add(text.substr(plain, at - plain), false);
      add(text.substr(at + mark.size(), end - at - mark.size()), true);
      at = plain = end + mark.size();
      continue;
    }
    const std::size_t middle = text[at] == '[' ? text.find("](", at) : std::string_view::npos;
    const std::size_t end = middle == std::string_view::npos ? middle : text.find(')', middle);
    if (end == std::string_view::npos || text.substr(at, middle - at).find(']') != std::string_view::npos) {
      ++at;
      continue;
    }
    add(text.substr(plain, at - plain), false);
    for (const MarkdownSpan& inside : markdown_spans(text.substr(at + 1, middle - at - 1), note))
      spans.push_back(inside);
    add(note(text.substr(middle + 2, end - middle - 2)), false);
    at = plain = end + 1;
  }
  add(text.substr(plain), false);
  return spans;
}

std::string markdown_plain(std::string_view text, LinkNote note) {
  std::string plain;
  for (const MarkdownSpan& span : markdown_spans(text, note)) plain += span.text;
  return plain;
}

std::vector<std::string> markdown_table(const MarkdownBlock& table, std::size_t width, LinkNote note) {
  std::vector<std::vector<std::string>> rows = table.rows;
  for (std::vector<std::string>& row : rows) {
    for (std::string& cell : row) cell = markdown_plain(cell, note);
  }
  const std::vector<std::size_t> widths = column_widths(rows);
  std::size_t before_last = 0;
  for (std::size_t k = 0; k + 1 < widths.size(); ++k) before_last += widths[k] + 2;
  constexpr std::size_t kLeastLastColumn = 24;
  if (before_last + std::min(kLeastLastColumn, widths.empty() ? 0 : widths.back()) > width)
    return row_by_row(rows, width);
  std::vector<std::string> lines;
  for (const std::vector<std::string>& row : rows) add_row(lines, row, widths, width - before_last);
  return lines;
}

std::vector<std::string> filled(std::string_view text, std::size_t width) {
  std::vector<std::string> lines;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    if (!lines.empty() && columns_of(lines.back()) + 1 + columns_of(word) <= width) (lines.back() += ' ') += word;
    else lines.emplace_back(word);
    text.remove_prefix(end);
  }
  return lines;
}

}  // namespace collided::cli
