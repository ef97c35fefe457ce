#include <gtest/gtest.h>

#include "server/intake/readers/names.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

TEST(IntakeNames, OnlyPrintableUtf8OfTheRightLengthIsFit) {
  for (const char* good : {"a", "Gel\xc3\xa4nde", "\xe6\xa3\x9a", "\xf0\x9f\x93\xa6", "a/b#2"}) {
    EXPECT_EQ(flaw_of_name(good), "") << good;
    EXPECT_EQ(mended_name(good), good);
  }
  for (const char* bad :
       {"", "\xff", "caf\xe9", "\xc0\xaf", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\xe6\xa3", "a\nb", "\x7f"}) {
    EXPECT_NE(flaw_of_name(bad), "") << bad;
  }
  EXPECT_EQ(mended_name("caf\xe9\n"), "caf??");
  EXPECT_EQ(flaw_of_name(std::string(255, 'x')), "");
  EXPECT_NE(flaw_of_name(std::string(256, 'x')), "");
  const std::string cut = mended_name(std::string(254, 'x') + "\xc3\xa4");
  EXPECT_EQ(cut, std::string(254, 'x'));
}

TEST(IntakeNames, LongNamesStayUniqueWhenCut) {
  const std::string common(300, 'n');
  const test::Loaded loaded =
      test::load("s.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no " + common + "a\nf 1 2 3\no " + common + "b\nf 3 2 1\n");
  ASSERT_EQ(loaded.scene.parts.size(), 2u);
  EXPECT_EQ(loaded.scene.parts[0].name.size(), 255u);
  EXPECT_EQ(loaded.scene.parts[1].name, loaded.scene.parts[0].name.substr(0, 253) + "#2");
  EXPECT_EQ(loaded.report.mended.size(), 2u);
}

TEST(IntakeNames, ANumberedNameThatIsTakenIsPassedOver) {
  const Scene scene =
      test::load("s.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 2 3\no a#2\nf 1 3 2\no a\nf 2 3 1\no a\nf 3 2 1\n")
          .scene;
  EXPECT_EQ(scene.parts[2].name, "s/a#3");
  EXPECT_EQ(scene.parts[3].name, "s/a#4");
}

TEST(IntakeNames, PartsWithoutANameAmongOthersAreUnnamed) {
  const Scene scene = test::load("s.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no a\nf 3 2 1\n").scene;
  EXPECT_EQ(scene.parts[0].name, "s/unnamed");
}

TEST(IntakeNames, TheSceneMayBeGivenAName) {
  EXPECT_EQ(test::load("s.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", {.name = "hall"}).scene.parts[0].name, "hall");
}

}  // namespace
}  // namespace collided::engine
