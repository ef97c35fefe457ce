#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "client/cli/guides/guide_page.hpp"
#include "client/cli/guides/man_page.hpp"
#include "client/cli/guides/markdown.hpp"
#include "client/cli/command.hpp"
#include "tests/cli/terminal.hpp"

namespace collided::cli {
namespace {

std::string no_note(std::string_view) { return {}; }
std::string bracketed(std::string_view target) { return " <" + std::string(target) + ">"; }

// The lines of a paragraph are one text; an item goes on in lines that are indented; a picture leaves nothing behind.
TEST(Guides, MarkdownIsReadBlockByBlock) {
  const auto blocks = markdown_blocks(
      "# Title\n\nOne\ntwo.\n\n![picture](a.png)\n\n- first\n  line\n- second\n\n```sh\n  # code\n```\n");
  ASSERT_EQ(blocks.size(), 5u);
  EXPECT_EQ(blocks[0].kind, MarkdownKind::heading);
  EXPECT_EQ(blocks[0].lines, std::vector<std::string>{"Title"});
  EXPECT_EQ(blocks[1].lines, std::vector<std::string>{"One two."});
  EXPECT_EQ(blocks[2].lines, std::vector<std::string>{"first line"});
  EXPECT_EQ(blocks[3].kind, MarkdownKind::item);
  EXPECT_EQ(blocks[4].lines, std::vector<std::string>{"  # code"});
}

// A link may hold code, and brackets without a target are text.
TEST(Guides, MarksLeaveAndLinksSayWhereTheyLead) {
  EXPECT_EQ(markdown_plain("**a** `b*c` [the `d`](e.md), [x] (y)", bracketed), "a b*c the d <e.md>, [x] (y)");
  EXPECT_EQ(markdown_plain("an `open mark and a * star", no_note), "an `open mark and a * star");
}

TEST(Guides, TablesBreakTheirLastColumnAndFallApartWhereEvenThatDoesNotFit) {
  const auto blocks =
      markdown_blocks("| code | means |\n|---|---|\n| `a|b` | one two three four five six seven eight |\n");
  ASSERT_EQ(blocks.size(), 1u);
  EXPECT_EQ(markdown_table(blocks[0], 40, no_note),
            (std::vector<std::string>{"code  means", "a|b   one two three four five six seven", "      eight"}));
  EXPECT_EQ(markdown_table(blocks[0], 28, no_note),
            (std::vector<std::string>{"a|b", "    means: one two three", "    four five six seven", "    eight"}));
}

// What roff would take for a command, an escape or another letter stands for itself.
TEST(Guides, ManualPagesShowTextAsItIs) {
  EXPECT_EQ(man_as_is(".a\n'b\\-c"), ".PP\n.nf\n\\&.a\n\\(aqb\\e\\-c\n.fi\n");
  const Guide guide{"sample", "# Sample\n\nYou want to see. Then more.\n\n## .Dots\n\n.first **bold**\n"};
  const std::string page = man_page(guide);
  EXPECT_NE(page.find("collided\\-sample \\- to see\n"), std::string::npos) << page;
  EXPECT_NE(page.find(".SH \\&.Dots\n"), std::string::npos) << page;
  EXPECT_NE(page.find("\\&.first \\fBbold\\fR\n"), std::string::npos) << page;
}

// Also the last verb of a full line, and no line is wider than a terminal.
TEST(Guides, HelpNamesEveryVerbAsAWordOfItsOwn) {
  std::istringstream help(collide("help").out);
  std::set<std::string> words;
  for (std::string word; help >> word;) words.insert(word);
  for (const Verb& verb : verbs()) {
    if (verb.group.empty()) continue;
    EXPECT_TRUE(words.contains(std::string(verb.name))) << verb.name;
  }
  help.clear();
  help.seekg(0);
  for (std::string line; std::getline(help, line);) EXPECT_LE(line.size(), 80U) << line;
}

TEST(Guides, HelpPrintsAGuideThatFitsAndListsThemAll) {
  const std::string help = collide("help").out;
  for (const Guide& guide : guides()) EXPECT_NE(help.find(guide.name), std::string::npos) << guide.name;
  const auto ran = collide("help asking");
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.out.find("Exit codes"), std::string::npos);
  EXPECT_NE(collide("help askin").err.find("did you mean 'asking'?"), std::string::npos);
  EXPECT_NE(guide_page(*find_guide("asking"), 60, true).find("\x1b[1mAsking\x1b[0m"), std::string::npos);
}

}  // namespace
}  // namespace collided::cli
