#include "client/cli/output/wrapping.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"

namespace collided::cli {
namespace {

// Enough for a role, a heading or both ends of a name.
constexpr std::size_t kLeastColumn = 16;

bool begins_character(char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }

bool is_number(std::string_view word) {
  for (const std::string_view sign : {"±", "+", "-"}) {
    if (word.starts_with(sign)) word.remove_prefix(sign.size());
  }
  return !word.empty() && (word.front() == '.' || (word.front() >= '0' && word.front() <= '9')) && is_number_text(word);
}

/// The word that ends before this position.
std::string_view word_before(std::string_view text, std::size_t end) {
  const std::size_t blank = text.substr(0, end).rfind(' ');
  const std::size_t begin = blank == std::string_view::npos ? 0 : blank + 1;
  return text.substr(begin, end - begin);
}

/// Where to break the text so that at most `width` columns come before: after the last double blank if that fills half
/// of them, else after the last blank that does not follow a number, else after the last blank; npos if there is none.
std::size_t break_before(std::string_view text, std::size_t width) {
  constexpr std::size_t kNone = std::string_view::npos;
  std::size_t any = kNone;
  std::size_t between_words = kNone;
  std::size_t two = kNone;
  for (std::size_t at = 1; at < text.size() && columns_of(text.substr(0, at)) <= width; ++at) {
    if (text[at] != ' ' || text.substr(0, at).ends_with("·")) continue;  // a separator stays with the second text
    any = at;
    if (!is_number(word_before(text, at))) between_words = at;
    if (at + 1 < text.size() && text[at + 1] == ' ') two = at;
  }
  // A label and a sentence: the label alone would leave the line empty.
  if (two != kNone && (2 * two >= width || between_words == kNone)) return two;
  return between_words != kNone ? between_words : any;
}

}  // namespace

std::size_t columns_of(std::string_view text) {
  std::size_t columns = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '\x1b') {
      at = std::min(text.find('m', at), text.size());
    } else if (begins_character(text[at])) {
      ++columns;
    }
  }
  return columns;
}

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  std::string lines;
  std::size_t room = width;
  while (width > 2 * indent && columns_of(text) > room) {
    // Blanks at the beginning are indentation; the text is not broken there.
    const std::size_t begin = std::min(text.find_first_not_of(' '), text.size());
    std::size_t at = break_before(text.substr(begin), room - std::min(room, begin));
    if (at == std::string_view::npos) at = text.substr(begin).find(' ');
    if (at == std::string_view::npos) break;
    lines += text.substr(0, begin + at);
    lines.erase(lines.find_last_not_of(' ') + 1);
    text.remove_prefix(begin + at);
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    if (text.empty()) return lines;
    lines += '\n' + std::string(indent, ' ');
    room = width - indent;
  }
  return lines + std::string(text);
}

bool holds_number(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (is_number(text.substr(0, end))) return true;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return false;
}

bool fit(std::vector<ColumnWidth>& widths, std::size_t width, std::size_t gap) {
  if (width == 0 || widths.empty()) return true;
  std::size_t all = gap * (widths.size() - 1);
  for (const ColumnWidth& one : widths) all += one.columns;
  const auto room = [](const ColumnWidth& one) { return one.may_shrink ? one.columns : 0; };
  for (; all > width; --all) {
    const auto widest = std::max_element(widths.begin(), widths.end(),
                                         [&](const ColumnWidth& a, const ColumnWidth& b) { return room(a) < room(b); });
    if (room(*widest) <= kLeastColumn) return false;
    --widest->columns;
  }
  return true;
}

std::string cut_to(std::string_view text, std::size_t width) {
  const std::size_t columns = columns_of(text);
  if (columns <= width || text.find('\x1b') != std::string_view::npos) return std::string(text);
  const std::size_t kept = std::max<std::size_t>(width, 1) - 1;
  const auto byte_of = [&](std::size_t character) {
    std::size_t at = 0;
    for (; at < text.size(); ++at)
      if (begins_character(text[at]) && character-- == 0) break;
    return at;
  };
  return fmt::format("{}…{}", text.substr(0, byte_of(kept / 2)), text.substr(byte_of(columns - (kept + 1) / 2)));
}

}  // namespace collided::cli
