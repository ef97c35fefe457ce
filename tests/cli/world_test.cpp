#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

/// Answers one command and keeps what was asked.
class World : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    asked.clear();
    fake::server().command = [this](const std::string& name, const nlohmann::json& arguments,
                                    const Shape& shape) -> Result<std::string> {
      asked.emplace_back(name, arguments);
      last_shape = shape;
      return replies.at(name).dump();
    };
  }

  std::map<std::string, nlohmann::json> replies{{"covers", {{"covers", nullptr}, {"version", 1}}},
                                                {"figures", nlohmann::json::object()}};
  std::vector<std::pair<std::string, nlohmann::json>> asked;
  Shape last_shape;
};

TEST_F(World, AddSendsShapeAndPose) {
  replies["add"] = {{"name", "crate"}, {"id", 7}, {"version", 18205}};
  const Ran ran = at_terminal("add crate box 0.4 0.4 0.4 --at 1 2 0.2 --layers 0b10 --group 3");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "added crate (world 18205)\n");
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_EQ(asked[0].second["pose"], nlohmann::json({1, 2, 0.2, 1, 0, 0, 0}));
  EXPECT_EQ(asked[0].second["layers"], 2);
  EXPECT_EQ(asked[0].second["group"], 3);
  EXPECT_EQ(asked[0].second["moving"], true);
  ASSERT_EQ(last_shape.size(), 1U);
  EXPECT_EQ(std::get<BoxShape>(last_shape[0]).half_m, Vec3(0.2, 0.2, 0.2));
}

TEST_F(World, MoveKeepsTheRotationUnlessOneIsGiven) {
  replies["get"] = {{"name", "crate"}, {"pose", {1, 2, 0.2, 0, 1, 0, 0}}};
  replies["move"] = {{"name", "crate"},
                     {"moved_m", 0.2},
                     {"began", {"shelf_3"}},
                     {"ended", nlohmann::json::array()},
                     {"version", 18206}};
  EXPECT_EQ(at_terminal("move crate 1.2 2 0.2").out, "moved crate 0.2 m; began to touch shelf_3\n");
  EXPECT_EQ(asked.back().second["pose"], nlohmann::json({1.2, 2, 0.2, 0, 1, 0, 0}));
  collide("move crate 0 0 -1 --by");
  EXPECT_EQ(asked.back().second["pose"], nlohmann::json({1, 2, -0.8, 0, 1, 0, 0}));
}

TEST_F(World, RemoveSaysWhatWentAndHowToBringItBack) {
  const nlohmann::json brief{{"name", "a crate"}, {"kind", "box"}, {"scene", ""}, {"publisher", ""}};
  const nlohmann::json box{{"box", {{"center", {0, 0, 0}}, {"half_m", {0.2, 0.2, 0.1}}, {"rotation", {1, 0, 0, 0}}}}};
  replies["list"] = {{"objects", {brief}}, {"count", 1}, {"version", 18206}};
  replies["get"] = {{"name", "a crate"}, {"shape", {box}},     {"pose", {1, 2, 0.2, 0, 1, 0, 0}},
                    {"layers", 2},       {"mask", 0xffffffff}, {"group", 0},
                    {"moving", true}};
  replies["remove"] = {{"removed", {"a crate"}}, {"ended", 1}, {"version", 18207}};
  const Ran ran = at_terminal("rm 'a crate'");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "removed a crate (world 18207); it had 1 open contact, ended (removed)\n");
  EXPECT_EQ(ran.err, "     undo: collide add 'a crate' box 0.4 0.4 0.2 --at 1 2 0.2 --quat 0 1 0 0 --layers 0x2\n");
  replies["remove"] = {{"removed", nlohmann::json::array()}, {"ended", 0}, {"version", 18207}};
  EXPECT_EQ(collide("rm 'crate*'").code, 1);
  replies["remove"] = {{"removed", {"a", "b", "c", "d", "e"}}, {"ended", 0}, {"version", 18208}};
  EXPECT_EQ(at_terminal("rm '*'").out, "removed a, b, c, d, e (world 18208)\n");
  replies["remove"] = {{"removed", {"a", "b", "c", "d", "e", "f", "g"}}, {"ended", 0}, {"version", 18209}};
  EXPECT_EQ(at_terminal("rm '*'").out, "removed a, b, c, d, e and 2 more (world 18209)\n");
}

// A name that nobody has is told with its neighbours; a glob is no name, and what the server says of it is all there is to say.
TEST_F(World, WhatCannotBeRemovedIsComparedWithNamesUnlessItIsAGlob) {
  fake::server().command = [](const std::string& name, const nlohmann::json&, const Shape&) -> Result<std::string> {
    if (name == "remove") return Error{ErrorCode::refused, "server refused: so it is", ""};
    return nlohmann::json{{"objects", {{{"name", "crate"}}, {{"name", "shelf"}}}}, {"count", 2}, {"version", 3}}.dump();
  };
  const Ran named = collide("rm crat -q");
  EXPECT_EQ(named.code, 5);
  EXPECT_EQ(named.err, "error: object 'crat' is not in the world (2 objects); nearest names: crate\n");
  for (const char* const glob : {"'crat*'", "'crat?'", "'[c]rat'", "'*'"}) {
    const Ran ran = collide(std::string("rm -q ") + glob);
    EXPECT_EQ(ran.code, 5) << glob;
    EXPECT_EQ(ran.err, "error: server refused: so it is\n") << glob;
  }
  EXPECT_EQ(collide("rm crate -q").err, "error: server refused: so it is\n") << "it is there";
}

TEST_F(World, LoadSendsAnAbsolutePathAndTheUnitInMetres) {
  replies["load"] = {{"scene", "warehouse"},
                     {"triangles", 1204118},
                     {"parts", 312},
                     {"objects", 40},
                     {"seconds", 0.412},
                     {"mended", {"18 T-vertices"}},
                     {"refused", nlohmann::json::array()},
                     {"warnings", nlohmann::json::array()},
                     {"left_out", {"moving index"}},
                     {"version", 18210}};
  const Ran ran = at_terminal("load warehouse.obj --unit mm --up y");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out,
            "loaded 'warehouse' in 412 ms  world 18210\n"
            "  312 parts, 1 204 118 triangles, 40 objects\n"
            "  mended   18 T-vertices\n");
  EXPECT_EQ(at_terminal("load warehouse.obj -q").out, "");
  EXPECT_EQ(collide("load warehouse.obj").out, "warehouse\t312\t1204118\t40\t[]\t[]\t18210\n");
  EXPECT_EQ(asked[0].second["unit_m"], 0.001);
  EXPECT_EQ(asked[0].second["up"], "y");
  EXPECT_EQ(asked[0].second["path"].get<std::string>().front(), '/');
}

TEST_F(World, LoadAndStatusKnowWhatIsCovered) {
  replies["load"] = {{"scene", "hall"},
                     {"triangles", 1},
                     {"parts", 1},
                     {"objects", 0},
                     {"seconds", 0.1},
                     {"version", 5},
                     {"covers", {{-1.0, 0.0, 0.0, 1.0, 1.0, "inf"}}}};
  const Ran ran = collide("load hall.obj --covers -1,0,0:1,1m,inf --covers 5,5,5:6,6,6 --fields covers");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(asked[0].second["covers"], nlohmann::json({{-1, 0, 0, 1, 1, "inf"}, {5, 5, 5, 6, 6, 6}}));
  EXPECT_EQ(ran.out, "[[-1.0,0.0,0.0,1.0,1.0,\"inf\"]]\n");
  for (const char* wrong : {"1,2,3", "1,2,3:4,5", "1,2,3:0,5,6", "a:b", "0,0,nan:1,1,1"}) {
    EXPECT_EQ(collide("load hall.obj --covers " + std::string(wrong)).code, 2) << wrong;
  }
  EXPECT_EQ(asked.size(), 1U);
  fake::server().status.state = "ready";
  replies["covers"] = {{"covers", {{-1, 0, 0, 1, 1, "inf"}}}, {"version", 5}};
  EXPECT_NE(at_terminal("status").out.find("\ncovers -1 0 0 to 1 1 inf\n"), std::string::npos)
      << at_terminal("status").out;
  EXPECT_EQ(collide("status --fields covers").out, "[[-1,0,0,1,1,\"inf\"]]\n");
  replies["covers"] = {{"covers", nullptr}, {"version", 5}};
  EXPECT_EQ(at_terminal("status").out.find("cover"), std::string::npos);
}

TEST_F(World, UploadSendsTheBytesAndANameThatIsOne) {
  replies["load"] = {{"scene", "part"}, {"triangles", 1}, {"parts", 1},
                     {"objects", 0},    {"seconds", 0.1}, {"version", 5}};
  const ScratchFile file("a part$.obj", "v 0 0 0\n");
  const Ran ran = collide("load --upload '" + file.path() + "' --name part --fields scene");
  EXPECT_EQ(ran.out, "part\n") << ran.err;
  EXPECT_EQ(asked[0].second["uploaded"], "a_part_.obj:v 0 0 0\n");
  EXPECT_EQ(asked[0].second["name"], "part");
  EXPECT_FALSE(asked[0].second.contains("path"));
  EXPECT_EQ(collide("load --upload /no/such/file.obj").code, 2);
  EXPECT_EQ(collide("load --upload robot.urdf --srdf robot.srdf").code, 2);
}

TEST_F(World, ListIsATableOrRecords) {
  replies["list"] = {{"objects",
                      {{{"name", "drone_2"},
                        {"id", 5},
                        {"kind", "sphere"},
                        {"moving", true},
                        {"scene", ""},
                        {"publisher", "fleet"},
                        {"position", {1, 2, 3}},
                        {"triangles", 0},
                        {"layers", 1},
                        {"stale", false}}}},
                     {"count", 1},
                     {"version", 9}};
  EXPECT_EQ(at_terminal("ls --moving 'drone_*'").out,
            "OBJECT   KIND    MOVES  AT     FROM\ndrone_2  sphere  yes    1 2 3  fleet\n");
  EXPECT_EQ(asked[0].second["moving"], true);
  EXPECT_EQ(asked[0].second["name"], "drone_*");
  EXPECT_EQ(collide("ls --json --fields name,position,layers").out,
            "{\"name\":\"drone_2\",\"position\":[1,2,3],\"layers\":1}\n");
  EXPECT_EQ(collide("ls --count").out, "1\n");
}

TEST_F(World, AGlobInBracketsArrivesWhole) {
  replies["list"] = {{"objects", nlohmann::json::array()}, {"count", 0}, {"version", 9}};
  EXPECT_EQ(collide("ls '[ab,c]'").code, 1);
  EXPECT_EQ(asked[0].second["name"], "[ab,c]");
}

TEST_F(World, PlanSaysWhy) {
  replies["plan"] = {
      {"structures", {{{"structure", "grid"}, {"built", false}, {"why", "nothing moves"}, {"saves", "2 MB"}}}},
      {"pairs", {{{"a", "sphere"}, {"b", "box"}, {"how", "closed form"}}}},
      {"wings", {{{"name", "fleet"}, {"in_use", true}}, {{"name", "keys"}, {"in_use", false}}}}};
  EXPECT_EQ(at_terminal("plan").out,
            "left out  grid: nothing moves; saves 2 MB\n"
            "wings     fleet (in use), keys\n");
  EXPECT_EQ(collide("plan --wings").out, "fleet\ttrue\nkeys\tfalse\n");
  EXPECT_EQ(collide("plan --pairs").out, "sphere\tbox\tclosed form\n");
}

TEST_F(World, GetShowsTheObject) {
  replies["get"] = {{"name", "crate"},
                    {"id", 7},
                    {"kind", "box"},
                    {"moving", true},
                    {"scene", ""},
                    {"publisher", ""},
                    {"layers", 2},
                    {"pose", {1, 2, 0.2, 1, 0, 0, 0}},
                    {"bounds", {{0.8, 1.8, 0}, {1.2, 2.2, 0.4}}},
                    {"solid", true},
                    {"contacts", {"shelf_3"}}};
  EXPECT_EQ(at_terminal("get crate").out,
            "crate  box  moving\n"
            "  pose      1 2 0.2 1 0 0 0\n"
            "  bounds    0.8 1.8 0  to  1.2 2.2 0.4\n"
            "  solid     yes\n"
            "  layers    0x2\n"
            "  contacts  shelf_3\n");
  EXPECT_EQ(collide("get crate --json --fields name,bounds").out,
            "{\"name\":\"crate\",\"bounds\":[[0.8,1.8,0],[1.2,2.2,0.4]]}\n");
  replies["get"]["solid"] = false;
  replies["get"]["solid_by"] = "winding";
  EXPECT_NE(at_terminal("get crate").out.find("  solid     by winding number\n"), std::string::npos);
  EXPECT_EQ(collide("get crate --fields solid,solid_by").out, "false\twinding\n");
}

TEST_F(World, StatusNamesServerSceneAndPublishers) {
  ServerStatus status;
  status.version_text = "0.1.0";
  status.pid = 4711;
  status.name_space = "collided";
  status.state = "ready";
  status.scenes = {"warehouse"};
  status.static_triangles = 1'204'118;
  status.publishers = {{"lift_plc", 7, std::chrono::seconds(4), true}};
  fake::server().status = status;
  const Ran ran = at_terminal("status");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out,
            "collided 0.1.0 pid 4711  domain 0  namespace collided  ready\n"
            "scene warehouse  1 204 118 triangles  ·  0 objects, 0 moving  ·  0 open contacts  ·  world 0\n"
            "poses 0 applied, 0 dropped  ·  questions 0 answered, 0 refused, 0 undecided\n"
            "publisher lift_plc  lost, silent for 4 s\n");
  fake::server().status.contacts_truncated = true;
  EXPECT_NE(at_terminal("status").out.find("contacts are missing"), std::string::npos);
  EXPECT_NE(collide("status --json").out.find("\"contacts_truncated\":true"), std::string::npos);
}

TEST_F(World, TheConnectionComesFromFlagsThenTheEnvironment) {
  const auto options = [](const std::string& words, std::map<std::string, std::string> environment) {
    const Ran ran = collide(words, {.in = {}, .environment = std::move(environment)});
    EXPECT_EQ(ran.err, "") << words;
    return fake::server().connected_with;
  };
  EXPECT_EQ(options("status", {}).domain, 0);
  EXPECT_EQ(options("status", {{"ROS_DOMAIN_ID", "7"}}).domain, 7);
  EXPECT_EQ(options("status", {{"ROS_DOMAIN_ID", "7"}, {"COLLIDED_DOMAIN", "8"}}).domain, 8);
  EXPECT_EQ(options("--domain 9 status", {{"COLLIDED_DOMAIN", "8"}}).domain, 9);
  const ConnectOptions all =
      options("status --namespace lab --interface auto --wait 5s --peer 10.0.0.2 --peer host", {});
  EXPECT_EQ(all.name_space, "lab");
  EXPECT_EQ(all.interface, "auto");
  EXPECT_EQ(all.wait, std::chrono::seconds(5));
  EXPECT_TRUE(all.wait_is_limit);
  EXPECT_EQ(all.peers, (std::vector<std::string>{"10.0.0.2", "host"}));
}

TEST_F(World, ManyVerbsShareOneConnection) {
  replies["add"] = {{"name", "crate"}, {"id", 7}, {"version", 18205}};
  replies["remove"] = {{"removed", {"crate"}}, {"ended", 1}, {"version", 18207}};
  replies["list"] = {{"objects", nlohmann::json::array()}, {"count", 0}, {"version", 9}};
  fake::server().ray = [](const RayQuestion&, const AskOptions& options) {
    EXPECT_TRUE(options.fresh);
    return fake::hit_answer({fake::hit("crate", 4.6, {1, 2, 0.4})});
  };
  const Ran ran =
      collide("- --table",
              {.in = "# a crate\nadd crate box 0.4 0.4 0.4 --at 1 2 0.2\n\nray 1 2 5  0 0 -1 --fresh -q\nrm crate\n"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out,
            "added crate (world 18205)\n"
            "hit  crate  distance 4.6 m  at 1 2 0.4  normal 0 0 1\n"
            "removed crate (world 18207); it had 1 open contact, ended (removed)\n");
  EXPECT_EQ(fake::server().connect_count, 1);
}

// What undoes a removal makes the same object again.
TEST_F(World, TheUndoLineIsACommandOfCollide) {
  const nlohmann::json brief{{"name", "it's"}, {"kind", "capsule"}, {"scene", ""}, {"publisher", ""}};
  const nlohmann::json capsule{{"capsule", {{"a", {0, 0, -0.15}}, {"b", {0, 0, 0.15}}, {"radius_m", 0.05}}}};
  replies["list"] = {{"objects", {brief}}, {"count", 1}, {"version", 18206}};
  replies["get"] = {{"name", "it's"}, {"shape", {capsule}}, {"pose", {-1, 2, -0.2, 1, 0, 0, 0}},
                    {"layers", 1},    {"mask", 6},          {"group", 3},
                    {"moving", false}};
  replies["remove"] = {{"removed", {"it's"}}, {"ended", 0}, {"version", 18207}};
  replies["add"] = {{"name", "it's"}, {"id", 8}, {"version", 18208}};
  const std::string hint = collide("rm \"it's\"").err;
  const std::string command = hint.substr(hint.find("collide ") + 8);
  ASSERT_EQ(collide(command.substr(0, command.find('\n'))).code, 0) << command;
  EXPECT_EQ(asked.back().second["name"], "it's");
  EXPECT_EQ(asked.back().second["pose"], nlohmann::json({-1, 2, -0.2, 1, 0, 0, 0}));
  EXPECT_EQ(asked.back().second["mask"], 6);
  EXPECT_EQ(asked.back().second["group"], 3);
  EXPECT_EQ(asked.back().second["moving"], false);
  EXPECT_EQ(std::get<CapsuleShape>(last_shape[0]).a, Vec3(0, 0, -0.15));
  EXPECT_EQ(std::get<CapsuleShape>(last_shape[0]).radius_m, 0.05);
}

// Every shape that `add` makes without a file comes back; a plane never moves, so its line does not say so.
TEST_F(World, WhatAddMadeHasALineThatMakesIt) {
  const auto line_of = [&](const nlohmann::json& shape, bool moving) {
    replies["list"] = {{"objects", {{{"name", "it"}, {"scene", ""}, {"publisher", ""}}}}, {"count", 1}};
    replies["get"] = {{"name", "it"},    {"shape", {shape}},   {"pose", {500000, 0, 0, 1, 0, 0, 0}},
                      {"layers", 1},     {"mask", 0xffffffff}, {"group", 0},
                      {"moving", moving}};
    replies["remove"] = {{"removed", {"it"}}, {"ended", 0}, {"version", 2}};
    return collide("rm it").err;
  };
  const nlohmann::json low{0, 0, -0.25}, high{0, 0, 0.25}, zero{0, 0, 0};
  const std::string undo = "     undo: collide add it ";
  EXPECT_EQ(line_of({{"cylinder", {{"a", low}, {"b", high}, {"radius_m", 0.1}}}}, true),
            undo + "cylinder 0.1 0.5 --at 500000 0 0\n");
  EXPECT_EQ(line_of({{"cone", {{"apex", high}, {"base", low}, {"radius_m", 0.1}}}}, true),
            undo + "cone 0.1 0.5 --at 500000 0 0\n");
  EXPECT_EQ(line_of({{"ellipsoid", {{"center", zero}, {"half_m", {0.5, 1, 1.5}}, {"rotation", {1, 0, 0, 0}}}}}, true),
            undo + "ellipsoid 1 2 3 --at 500000 0 0\n");
  EXPECT_EQ(line_of({{"half_space", {{"point", zero}, {"normal", {0, 0, 1}}}}}, false),
            undo + "plane 0 0 1 --at 500000 0 0\n");
  const std::string none = "     1 more that no line here brings back\n";
  EXPECT_EQ(line_of({{"cone", {{"apex", low}, {"base", high}, {"radius_m", 0.1}}}}, true), none) << "add makes no such";
  EXPECT_EQ(line_of({{"hull", {{"vertices", 8}, {"faces", 12}}}}, true), none);
}

// The scene is still there when its parts are gone, so its file is loaded in its place.
TEST_F(World, PartsOfASceneComeBackWithItsFile) {
  const auto of = [](const char* name, const char* scene) {
    return nlohmann::json{{"name", name}, {"scene", scene}, {"publisher", ""}};
  };
  replies["list"] = {{"objects", {of("cell/bench", "cell"), of("cell/post", "cell"), of("sent/door", "sent")}},
                     {"count", 3}};
  replies["plan"] = {{"scenes",
                      {{{"scene", "cell"}, {"load", {{"path", "/srv/cell.csv"}}}},
                       {{"scene", "hall"}, {"load", {{"path", "/srv/hall.obj"}}}},
                       {{"scene", "sent"}, {"load", nullptr}}}}};
  replies["remove"] = {{"removed", {"cell/bench", "cell/post", "sent/door"}}, {"ended", 0}, {"version", 2}};
  replies["clear"] = {{"removed", 3}, {"ended", 0}, {"version", 2}};
  const std::string lines =
      "     undo: collide load /srv/cell.csv --replace\n     1 more that no line here brings back\n";
  EXPECT_EQ(collide("rm '*'").err, lines);
  EXPECT_EQ(asked.back().first, "remove") << "the lines are known before anything is lost";
  EXPECT_EQ(collide("clear --moving").err, lines);
  EXPECT_EQ(collide("clear hall --moving").err, lines + "     undo: collide load /srv/hall.obj\n");
  EXPECT_EQ(collide("clear cell").err, "     undo: collide load /srv/cell.csv\n");
}

// The lines load each scene as it was loaded; a file that a client sent has none.
TEST_F(World, ClearSaysHowToLoadTheScenesAgain) {
  replies["plan"] = {{"scenes",
                      {{{"scene", "warehouse"}, {"load", {{"path", "embedded:"}}}},
                       {{"scene", "hall"},
                        {"load", {{"path", "/srv/big hall.obj"}, {"name", "hall"}, {"unit_m", 0.001}, {"mend", true}}}},
                       {{"scene", "sent"}, {"load", nullptr}}}}};
  replies["list"] = {{"objects", nlohmann::json::array()}, {"count", 0}, {"version", 9}};
  replies["clear"] = {{"removed", 48}, {"kept", 2}, {"ended", 3}, {"version", 10}};
  const Ran ran = at_terminal("clear");
  EXPECT_EQ(ran.out, "removed 48 objects, ended 3 contacts (world 10); 2 belong to publishers that live and stay\n");
  EXPECT_EQ(ran.err,
            "     undo: collide load embedded:\n"
            "     undo: collide load '/srv/big hall.obj' --name hall --unit 0.001 --mend\n"
            "     1 more that no line here brings back\n");
}

TEST_F(World, AShellRunsLinesFromAPipeAndNoneInsideAnother) {
  replies["remove"] = {{"removed", {"crate"}}, {"ended", 0}, {"version", 2}};
  replies["list"] = {{"objects", nlohmann::json::array()}, {"count", 0}, {"version", 9}};
  const Ran ran = collide("shell", {.in = "shell\n-\ncollide rm crate\n"});
  EXPECT_EQ(ran.code, 6);
  EXPECT_EQ(ran.out, "[\"crate\"]\t0\t2\n");
  EXPECT_NE(ran.err.find("error: line 1: 'shell' has no meaning here"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("error: line 2: '-' has no meaning here"), std::string::npos) << ran.err;
}

TEST_F(World, ALineThatFailsIsNamedAndTheNextRuns) {
  replies["list"] = {{"objects", nlohmann::json::array()}, {"count", 0}, {"version", 9}};
  replies["remove"] = {{"removed", {"crate"}}, {"ended", 0}, {"version", 2}};
  const Ran ran = collide("-", {.in = "ray 1 2\nrm crate\n"});
  EXPECT_EQ(ran.code, 6);
  EXPECT_EQ(ran.out, "[\"crate\"]\t0\t2\n");
  EXPECT_EQ(ran.err,
            "error: line 1: ray: 2 numbers; a ray takes 6, start and direction, or 3 and --to X Y Z\n       collide "
            "help ray\n");
}

}  // namespace
}  // namespace collided
