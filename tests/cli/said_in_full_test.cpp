#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

/// What the command line says, compared whole.
class SaidInFull : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().command = [this](const std::string& name, const nlohmann::json&,
                                    const Shape&) -> Result<std::string> { return replies.at(name).dump(); };
  }
  std::map<std::string, nlohmann::json> replies{{"covers", {{"covers", nullptr}, {"version", 1}}}};
};

TEST_F(SaidInFull, TheVersionOnATerminalIsThatOfTheLibrary) {
  const Ran ran = at_terminal("version");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "collide " + std::string(library_version()) + "\n");
}

TEST_F(SaidInFull, AnyAndAllAreEachAllowedAlone) {
  fake::server().ray = [](const RayQuestion&, const AskOptions&) {
    return fake::hit_answer({fake::hit("wall", 1, {0, 0, 4})});
  };
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --any").code, 0);
  EXPECT_EQ(fake::server().last_options.mode, HitMode::any);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --all").code, 0);
  EXPECT_EQ(fake::server().last_options.mode, HitMode::all);
  EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --any --all").code, 2);
}

// Of three objects the server lists one, and of that one its scene brings it back.
TEST_F(SaidInFull, UndoCountsWhatIsNotListedAndWhatNoLineBringsBack) {
  const nlohmann::json part{{"name", "hall/floor"}, {"kind", "mesh"}, {"scene", "hall"}, {"publisher", ""}};
  const nlohmann::json brief{{"name", "ball"}, {"kind", "sphere"}, {"scene", ""}, {"publisher", ""}};
  const nlohmann::json sphere{{"sphere", {{"center", {0, 0, 0}}, {"radius_m", 0.25}}}};
  replies["list"] = {{"objects", {part, brief}}, {"count", 5}, {"version", 2}};
  replies["get"] = {{"name", "ball"}, {"shape", {sphere}},  {"pose", {1, -0.0, 3, 1, 0, 0, 0}},
                    {"layers", 1},    {"mask", 0xffffffff}, {"group", 0},
                    {"moving", true}};
  replies["plan"] = {{"scenes", {{{"scene", "hall"}, {"load", nullptr}}}}};
  replies["clear"] = {{"removed", 5}, {"ended", 0}, {"version", 3}};
  const Ran ran = at_terminal("clear");
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.err.find("     undo: collide add ball sphere 0.25 --at 1 0 3\n"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("     3 more that no line here brings back\n"), std::string::npos) << ran.err;
}

// A miss is no answer where nobody has the name that was asked for.
TEST_F(SaidInFull, AGlobThatNobodyMatchesIsSaidByEveryVerb) {
  replies["list"] = {{"objects", nlohmann::json::array()}, {"count", 0}, {"version", 2}};
  const std::string hint = "no object's name matches --only 'palet*'\n";
  EXPECT_EQ(collide("ray - --only 'palet*'", {.in = "0 0 5 0 0 -1\n"}).err, hint);
  EXPECT_EQ(collide("ray - --only 'palet*' -q", {.in = "0 0 5 0 0 -1\n"}).err, "");
  EXPECT_TRUE(collide("watch --only 'palet*' --for 1ms").err.starts_with(hint));
  EXPECT_TRUE(collide("ray 0 0 5 0 0 -1 --watch --only 'palet*' --for 1ms").err.starts_with(hint));
  EXPECT_EQ(collide("ls 'palet*'").err, "no object's name matches 'palet*'\n");
  EXPECT_EQ(collide("ls").err, "no objects; 'collide load FILE' and 'collide add' put some into the world\n")
      << "the world is empty";
  replies["list"] = {{"objects", nlohmann::json::array()}, {"count", 3}, {"version", 2}};
  EXPECT_EQ(collide("ray - --only 'palet*'", {.in = "0 0 5 0 0 -1\n"}).err, "");
}

TEST_F(SaidInFull, APoseIsRoundedForPeopleAndNeverHasAnExponent) {
  replies["get"] = {{"name", "crate"},
                    {"kind", "box"},
                    {"pose", {500000, 0.1 + 0.2, 0, 0.7071067811865476, 0, 0, 0.7071067811865476}},
                    {"bounds", {{499999.5, 0, 0}, {500000.5, 1, 1}}}};
  const std::string out = at_terminal("get crate").out;
  EXPECT_NE(out.find("  pose      500000 0.3 0 0.707107 0 0 0.707107\n"), std::string::npos) << out;
  EXPECT_NE(out.find("  bounds    499999.5 0 0  to  500000.5 1 1\n"), std::string::npos) << out;
  const std::string full = at_terminal("get crate -v").out;
  EXPECT_NE(full.find("  pose      500000 0.30000000000000004 0 "), std::string::npos) << full;
}

}  // namespace
}  // namespace collided
