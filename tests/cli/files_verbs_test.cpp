// The verbs that a sibling program answers: it gets the words as they were typed, and its code is ours.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/cli/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

/// Runs the words with a program in its place that keeps its own words, one a line, and ends with this code.
class FilesVerbs : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().connect_error = Error{ErrorCode::no_server, "nobody", ""};
    std::filesystem::permissions(program_.path(), std::filesystem::perms::owner_all);
  }
  std::string words_of(const std::string& words) {
    ran_ = collide(words, {.environment = {{"COLLIDED_FILES", program_.path()}}});
    std::ifstream in(program_.path() + ".words");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  ScratchFile program_{"files", "#!/bin/sh\nprintf '%s\\n' \"$@\" >\"$0.words\"\nexit 4\n"};
  Ran ran_;
};

TEST_F(FilesVerbs, PassTheirWordsOnAsTheyAre) {
  EXPECT_EQ(words_of("check a.obj --json --help --no-such-option"), "check\na.obj\n--json\n--help\n--no-such-option\n");
  EXPECT_EQ(ran_.code, 4);
  EXPECT_EQ(ran_.err, "");
  EXPECT_EQ(words_of("convert a.ply b.cscene --shift -1 -q"), "convert\na.ply\nb.cscene\n--shift=-1\n-q\n");
  EXPECT_EQ(ran_.code, 4);
  EXPECT_EQ(words_of("implicit 'x^2 - 1' -1 -2 5  0 0 -1 --json"), "implicit\nx^2 - 1\n-1\n-2\n5\n0\n0\n-1\n--json\n");
  EXPECT_EQ(ran_.code, 4);
}

TEST_F(FilesVerbs, SayWhichProgramIsMissing) {
  const Ran ran = collide("check a.obj", {.environment = {{"COLLIDED_FILES", program_.path() + ".missing"}}});
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.err.find("error: check: the program collided-files was not found"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("it is installed with collide; COLLIDED_FILES may name it"), std::string::npos) << ran.err;
}

TEST_F(FilesVerbs, SayWhatEndedIt) {
  std::ofstream(program_.path()) << "#!/bin/sh\nkill -TERM $$\n";
  words_of("check a.obj");
  EXPECT_EQ(ran_.err, "error: collided-files was ended by signal 15\n");
  std::ofstream(program_.path()) << "#!/bin/sh\nkill -INT $$\n";
  words_of("check a.obj");
  EXPECT_EQ(ran_.code, 130);
  EXPECT_EQ(ran_.err, "");
}

}  // namespace
}  // namespace collided
