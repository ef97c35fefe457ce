#include "client/cli/guides/guide_page.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "client/cli/guides/markdown.hpp"

namespace collided::cli {
namespace {

constexpr std::size_t kWidest = 100;  // longer lines are hard to follow

std::string help_note(std::string_view target) {
  const std::string guide = guide_of_link(target);
  if (!guide.empty()) return fmt::format(" (collide help {})", guide);
  return target.starts_with("http") ? fmt::format(" <{}>", target) : std::string();
}

std::string strong(std::string_view text, bool bright) {
  return bright ? fmt::format("\x1b[1m{}\x1b[0m", text) : std::string(text);
}

/// Each word by itself, so that a line may end between two of them.
std::string bright_words(const std::string& text, bool bright) {
  std::string result;
  for (const MarkdownSpan& span : markdown_spans(text, help_note)) {
    if (!span.strong) {
      result += span.text;
      continue;
    }
    std::string_view left = span.text;
    while (!left.empty()) {
      const std::size_t end = std::min(left.find(' '), left.size());
      result += strong(left.substr(0, end), bright && end > 0);
      if (end < left.size()) result += ' ';
      left.remove_prefix(std::min(end + 1, left.size()));
    }
  }
  return result;
}

void add_indented(std::string& page, const std::vector<std::string>& lines, std::string_view first,
                  std::size_t indent) {
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (!lines[k].empty()) page += k == 0 ? fmt::format("{:<{}}", first, indent) : std::string(indent, ' ');
    page += lines[k] + '\n';
  }
}

}  // namespace

std::string guide_of_link(std::string_view target) {
  target = target.substr(0, target.find('#'));
  if (!target.ends_with(".md")) return {};
  const Guide* guide = find_guide(target.substr(0, target.size() - 3));
  return guide == nullptr ? std::string() : std::string(guide->name);
}

std::string guide_page(const Guide& guide, std::size_t width, bool bright) {
  width = std::min(width, kWidest);
  std::string page;
  bool was_item = false;
  for (const MarkdownBlock& block : markdown_blocks(guide.markdown)) {
    const bool is_item = block.kind == MarkdownKind::item;
    if (!page.empty() && !(was_item && is_item)) page += '\n';
    was_item = is_item;
    switch (block.kind) {
      case MarkdownKind::heading:
        page += strong(block.lines.front(), bright) + '\n';
        if (!bright) page += std::string(block.lines.front().size(), block.level == 1 ? '=' : '-') + '\n';
        break;
      case MarkdownKind::paragraph:
        add_indented(page, filled(bright_words(block.lines.front(), bright), width), "", 0);
        break;
      case MarkdownKind::item:
        add_indented(page, filled(bright_words(block.lines.front(), bright), width - block.marker.size() - 1),
                     block.marker, block.marker.size() + 1);
        break;
      case MarkdownKind::code: add_indented(page, block.lines, "", 4); break;
      case MarkdownKind::table: add_indented(page, markdown_table(block, width - 2, help_note), "", 2); break;
    }
  }
  return page;
}

}  // namespace collided::cli
