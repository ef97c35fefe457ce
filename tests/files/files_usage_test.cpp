#include <sstream>

#include "tests/files/files_program.hpp"

namespace collided::test {
namespace {

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

TEST_F(Files, WhatIsMissingOrUnknownIsSaidInWords) {
  EXPECT_EQ(run("check").text, "error: check: which file?\n       collide help check\n");
  EXPECT_EQ(run("convert").text, "error: convert: which file?\n       collide help convert\n");
  EXPECT_EQ(run("convert a.obj").text, "error: convert: which output?\n       collide help convert\n");
  EXPECT_EQ(run("implicit").text, "error: implicit: which surface?\n       collide help implicit\n");
  EXPECT_EQ(run("check a.obj --uni mm").text,
            "error: check: unknown option '--uni'; did you mean '--unit'?\n       collide help check\n");
  EXPECT_EQ(run("check a.obj --xyzzy").text, "error: check: unknown option '--xyzzy'\n       collide help check\n");
  EXPECT_EQ(run("check a.obj b.obj").text, "error: check: 'b.obj' has no meaning here\n       collide help check\n");
  EXPECT_EQ(run("check").code, 2);
}

TEST_F(Files, NoLineOfAHelpIsWiderThanATerminal) {
  for (const char* const verb : {"check", "convert", "implicit"}) {
    std::istringstream lines(run(std::string(verb) + " --help").text);
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 80u) << verb << ": " << line;
    EXPECT_GT(count, 5u) << verb;
  }
}

TEST_F(Files, QuietLeavesOutTheHint) {
  const std::string square = write("square.obj", kSquare);
  const std::string all = run("check " + square).text;
  const std::string hint = "  -v shows every place, --json gives it to programs\n";
  ASSERT_TRUE(all.ends_with(hint)) << all;
  EXPECT_EQ(run("check -q " + square).text, all.substr(0, all.size() - hint.size()));
}

TEST_F(Files, AFolderThatIsNotThereIsSaidBeforeAnythingIsRead) {
  const std::string folder = (folder_ / "nowhere").string();
  const FilesRan ran = run("convert " + write("square.obj", kSquare) + " " + folder + "/a.cscene");
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.text, "error: " + folder + "/a.cscene: there is no folder " + folder + ". Nothing was written.\n");
}

// A target that leaves one of two triangles leaves half of the square.
TEST_F(Files, SimplifyingThatTakesPartsAwayIsWarnedOf) {
  const std::string out = (folder_ / "out.cscene").string();
  const FilesRan ran = run("convert " + write("square.obj", kSquare) + " " + out + " --to 10%");
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(
      ran.text.find("  simplify  1 of 2 triangles, no point of either surface farther than 0.708 m from the other\n"
                    "  warning   that is 50 per cent of its size: parts of it are gone or bent; --to a larger number "
                    "keeps more\n"),
      std::string::npos)
      << ran.text;
  std::string grid;
  constexpr int kSide = 20;
  for (int i = 0; i < kSide * kSide; ++i)
    grid += "v " + std::to_string(i % kSide) + " " + std::to_string(i / kSide) + " 0\n";
  for (int i = 0; i < kSide * (kSide - 1); ++i) {
    if (i % kSide == kSide - 1) continue;
    const auto corner = [&](int offset) { return " " + std::to_string(i + offset + 1); };
    grid +=
        "f" + corner(0) + corner(1) + corner(kSide + 1) + "\nf" + corner(0) + corner(kSide + 1) + corner(kSide) + "\n";
  }
  const std::string kept = run("convert " + write("grid.obj", grid) + " " + out + " --to 10%").text;
  EXPECT_NE(kept.find("  simplify  "), std::string::npos) << kept;
  EXPECT_EQ(kept.find("  warning   that is"), std::string::npos) << kept;
}

TEST_F(Files, AnSrdfThatIsNoneIsRefused) {
  const std::string robot = write(
      "r.urdf",
      R"(<robot name="r"><link name="a"><collision><geometry><sphere radius="1"/></geometry></collision></link></robot>)");
  EXPECT_EQ(run("check " + robot + " --srdf " + robot).text,
            "error: r.urdf: it describes links and joints, so it is a URDF file; --srdf takes an SRDF file, with "
            "<disable_collisions>. Nothing was loaded.\n");
  EXPECT_EQ(run("check " + write("cube.obj", kCube) + " --srdf " + robot).text,
            "error: cube.obj: --srdf is for .urdf robots. Nothing was loaded.\n");
}

TEST_F(Files, LengthsHaveNoExponentWhereNoneIsNeeded) {
  const std::string far = write("far.obj", "v 500000 0 0\nv 500001 0 0\nv 500000 1 0\nf 1 2 3\n");
  const std::string text = run("check " + far).text;
  EXPECT_NE(text.find("  bounds   500000 0 0  to  500001 1 0\n"), std::string::npos) << text;
}

TEST_F(Files, ATriangleThatMeetsOneOfAnotherPartNamesBoth) {
  const std::string crossed = write("crossed.obj",
                                    "o floor\nv 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n"
                                    "o wall\nv .5 .5 -1\nv .5 .5 1\nv .7 .5 1\nf 4 5 6\n");
  const std::string text = run("check " + crossed).text;
  EXPECT_NE(text.find("floor triangle 0 with wall triangle 0\n"), std::string::npos) << text;
  const json place = checked(crossed)["findings"]["self_intersections"]["places"][0];
  EXPECT_EQ(place["object"], "crossed/floor");
  EXPECT_EQ(place["with"], json({{"object", "crossed/wall"}, {"triangle", 0}}));
}

}  // namespace
}  // namespace collided::test
