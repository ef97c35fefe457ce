#include "client/cli/guides/man_page.hpp"

#include <fmt/format.h>

#include <collided/client.hpp>

#include "client/cli/guides/guide_page.hpp"
#include "client/cli/guides/markdown.hpp"

namespace collided::cli {
namespace {

constexpr std::size_t kTableColumns = 72;  // a page of 80 less its margin

std::string manual_note(std::string_view target) {
  const std::string guide = guide_of_link(target);
  if (!guide.empty()) return fmt::format(" (collided-{}(7))", guide);
  return target.starts_with("http") ? fmt::format(" <{}>", target) : std::string();
}

/// What stands for itself: roff takes some letters as commands and makes others prettier than they were.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '\\': result += "\\e"; break;
      case '-': result += "\\-"; break;
      case '\'': result += "\\(aq"; break;
      case '`': result += "\\(ga"; break;
      case '^': result += "\\(ha"; break;
      case '~': result += "\\(ti"; break;
      case '"': result += "\\(dq"; break;
      case '\t': result += "    "; break;
      default: result += c;
    }
  }
  return result;
}

/// A line that begins with a dot is a command.
std::string escaped_line(std::string_view line) {
  return (line.starts_with('.') ? std::string("\\&") : std::string()) + escaped(line) + '\n';
}

std::string with_fonts(std::string_view text) {
  std::string result;
  for (const MarkdownSpan& span : markdown_spans(text, manual_note))
    result += span.strong ? "\\fB" + escaped(span.text) + "\\fR" : escaped(span.text);
  return (result.starts_with('.') ? "\\&" : "") + result + '\n';
}

std::string lines_as_is(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return man_as_is(text);
}

std::string man_block(const MarkdownBlock& block) {
  switch (block.kind) {
    case MarkdownKind::heading:
      return block.level <= 2 ? man_section(block.lines.front()) : ".SS " + escaped_line(block.lines.front());
    case MarkdownKind::paragraph: return ".PP\n" + with_fonts(block.lines.front());
    case MarkdownKind::item:
      return fmt::format(".IP \"{}\" 4\n{}", block.marker == "-" ? "\\(bu" : block.marker,
                         with_fonts(block.lines.front()));
    case MarkdownKind::code: return ".RS 4\n" + lines_as_is(block.lines) + ".RE\n";
    case MarkdownKind::table: return lines_as_is(markdown_table(block, kTableColumns, manual_note));
  }
  return {};
}

/// The guide's first sentence says what its reader wants: that of "You want to know what a ray meets" is the purpose.
std::string purpose_of(const std::vector<MarkdownBlock>& blocks) {
  for (const MarkdownBlock& block : blocks) {
    if (block.kind != MarkdownKind::paragraph) continue;
    std::string sentence = markdown_plain(block.lines.front(), manual_note);
    sentence.resize(std::min(sentence.find('.'), sentence.size()));
    constexpr std::string_view kBegin = "You want ";
    if (sentence.starts_with(kBegin)) sentence.erase(0, kBegin.size());
    return sentence;
  }
  return {};
}

}  // namespace

std::string man_head(std::string_view title, int section, std::string_view name, std::string_view purpose) {
  // No date: pages made twice from the same files are equal.
  return fmt::format(".TH \"{}\" {} \"\" \"Collided {}\" \"Collided\"\n.nh\n.ad l\n.SH NAME\n{} \\- {}\n", title,
                     section, library_version(), escaped(name), escaped(purpose));
}

std::string man_section(std::string_view heading) { return ".SH " + escaped_line(heading); }

std::string man_as_is(std::string_view text) {
  std::string result = ".PP\n.nf\n";
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    result += escaped_line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result + ".fi\n";
}

std::string man_page(const Guide& guide) {
  const std::vector<MarkdownBlock> blocks = markdown_blocks(guide.markdown);
  const std::string title = fmt::format("collided-{}", guide.name);
  std::string page = man_head(title, 7, title, purpose_of(blocks));
  page += man_section("DESCRIPTION");
  for (const MarkdownBlock& block : blocks) {
    if (block.kind != MarkdownKind::heading || block.level > 1) page += man_block(block);
  }
  return page + man_section("SEE ALSO") + ".BR collide (1),\n.BR collided (1)\n";
}

}  // namespace collided::cli
