#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "client/cli/command.hpp"
#include "client/cli/guides/guides.hpp"
#include "tests/cli/terminal.hpp"

namespace collided::cli {
namespace {

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

TEST(Guides, HelpComesWhateverElseIsWrong) {
  for (const char* words : {"ray -h", "ray --length soon -h", "ray -h --length", "ray --nothing --help"}) {
    const auto ran = collide(words);
    EXPECT_EQ(ran.code, 0) << words << ran.err;
    EXPECT_NE(ran.out.find("collide ray - what a ray meets"), std::string::npos) << words;
  }
}

TEST(Guides, HelpPrintsAGuideThatFitsAndListsThemAll) {
  const std::string help = collide("help").out;
  for (const Guide& guide : guides()) EXPECT_NE(help.find(guide.name), std::string::npos) << guide.name;
  const auto ran = collide("help asking");
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.out.find("Exit codes"), std::string::npos);
  EXPECT_NE(collide("help askin").err.find("did you mean 'asking'?"), std::string::npos);
  EXPECT_NE(ran.out.find("\nUnits\n-----\n"), std::string::npos) << "headings stand out";
}

}  // namespace
}  // namespace collided::cli
