#pragma once

#include <string>
#include <string_view>
#include <vector>

// The Markdown that the guides are written in: headings, paragraphs, lists, tables, code, emphasis, links.
namespace collided::cli {

enum class MarkdownKind { heading, paragraph, item, code, table };

/// kind    what it is
/// level   of a heading, 1 the greatest
/// marker  of an item: "-" or its number, "2."
/// lines   of code as written; of the others one text, its lines joined
/// rows    of a table, cell by cell
struct MarkdownBlock {
  MarkdownKind kind = MarkdownKind::paragraph;
  std::size_t level = 0;
  std::string marker = {};
  std::vector<std::string> lines = {};
  std::vector<std::vector<std::string>> rows = {};
};

/// Pictures, comments and the tags of HTML are left out.
std::vector<MarkdownBlock> markdown_blocks(std::string_view text);

/// Text of one kind within a paragraph. A link is its text and, as plain text behind it, what is said about its target.
struct MarkdownSpan {
  std::string text;
  bool strong = false;  // code, or between two stars
};

/// What is written behind a link's text about its target: " (page 2)"; nothing where the text is enough.
using LinkNote = std::string (*)(std::string_view target);

std::vector<MarkdownSpan> markdown_spans(std::string_view text, LinkNote note);

/// The same without marks.
std::string markdown_plain(std::string_view text, LinkNote note);

/// A table in lines of at most `width` columns, as far as words allow: its columns side by side, the last one broken; where
/// even that does not fit, a paragraph a row.
std::vector<std::string> markdown_table(const MarkdownBlock& table, std::size_t width, LinkNote note);

/// Words in lines of at most `width` columns; a word that is longer stays whole. Colours take no columns.
std::vector<std::string> filled(std::string_view text, std::size_t width);

}  // namespace collided::cli
