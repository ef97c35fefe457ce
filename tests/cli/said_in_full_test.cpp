#include <gtest/gtest.h>

#include "tests/cli/fake_client.hpp"
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

}  // namespace
}  // namespace collided
