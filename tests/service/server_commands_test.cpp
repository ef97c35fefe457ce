#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "idl/command_table.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

class ServerCommands : public testing_support::ServerTest {
 protected:
  static json done(Client& client, const std::string& command, const json& arguments, const Shape& shape = {}) {
    const Result<std::string> answer = client.command(command, arguments.dump(), shape);
    EXPECT_TRUE(answer) << answer.error().message << " " << answer.error().hint;
    return answer ? json::parse(*answer) : json::object();
  }
  static std::string refusal(Client& client, const std::string& command, const json& arguments,
                             const Shape& shape = {}) {
    const Result<std::string> answer = client.command(command, arguments.dump(), shape);
    EXPECT_FALSE(answer) << *answer;
    return answer ? std::string() : answer.error().message;
  }
  static json pose(double x, double y, double z) { return {x, y, z, 1, 0, 0, 0}; }
};

TEST_F(ServerCommands, AnObjectIsAddedMovedAndRemoved) {
  start();
  Client client = connect();
  Watch events = watch(client);
  const Shape crate{BoxShape{.half_m = {0.2, 0.2, 0.2}}};
  EXPECT_EQ(done(client, "add", {{"name", "crate"}, {"pose", pose(6, 0, 1)}}, crate)["name"], "crate");
  EXPECT_EQ(client.ask(RayQuestion{.origin = {6, 0, 5}, .direction = {0, 0, -1}})->hits[0].object, "crate");
  const json moved = done(client, "move", {{"name", "crate"}, {"pose", pose(6, 0, 0.1)}});
  EXPECT_NEAR(moved["moved_m"].get<double>(), 0.9, 1e-12);
  EXPECT_EQ(moved["began"], json({"warehouse/floor"}));
  EXPECT_EQ(next(events).kind, EventKind::began);
  const json object = done(client, "get", {{"name", "crate"}});
  EXPECT_EQ(object["kind"], "box");
  EXPECT_EQ(object["contacts"], json({"warehouse/floor"}));
  EXPECT_EQ(object["pose"], pose(6, 0, 0.1));
  ASSERT_TRUE(object.contains("age_ns"));
  EXPECT_GT(object["age_ns"], 0);
  EXPECT_LT(object["age_ns"], 60'000'000'000);
  EXPECT_FALSE(done(client, "get", {{"name", "warehouse/floor"}}).contains("age_ns"));
  const json removed = done(client, "remove", {{"name", "cra*"}});
  EXPECT_EQ(removed["removed"], json({"crate"}));
  EXPECT_EQ(removed["ended"], 1);
  EXPECT_EQ(next(events).reason, EndReason::removed);
}

// Without a word of it a move has a way, and what lies on it is met; a teleport has none.
TEST_F(ServerCommands, AMoveMeetsWhatLiesOnItsWayAndATeleportDoesNot) {
  start();
  Client client = connect();
  done(client, "add", {{"name", "crate"}, {"pose", pose(6, 0, 3)}}, {BoxShape{.half_m = {0.2, 0.2, 0.2}}});
  const json there = done(client, "move", {{"name", "crate"}, {"pose", pose(6, 0, -3)}});
  EXPECT_EQ(there["began"], json({"warehouse/floor"}));
  EXPECT_EQ(there["ended"], json({"warehouse/floor"}));
  EXPECT_EQ(there["moved_m"], 6);
  const json back = done(client, "move", {{"name", "crate"}, {"pose", pose(6, 0, 3)}, {"teleport", true}});
  EXPECT_EQ(back["began"], json::array());
  EXPECT_EQ(back["ended"], json::array());
  const json again = done(client, "move", {{"name", "crate"}, {"pose", pose(6, 0, -3)}, {"teleport", false}});
  EXPECT_EQ(again["began"], json({"warehouse/floor"}));
}

// The refusal is the only answer, and says what is allowed; the price list has the questions and the seed that were asked for.
TEST_F(ServerCommands, AMenuIsOfAsManyQuestionsAsWereAskedFor) {
  start();
  Client client = connect();
  EXPECT_EQ(refusal(client, "menu", {{"questions", 100'001}}),
            "server refused: menu: 'questions' is 100001; allowed: a whole number from 0 to 100000");
  EXPECT_EQ(refusal(client, "menu", {{"sed", 1}}),
            "server refused: menu: unknown argument 'sed'; did you mean 'seed'?");
  const json menu = done(client, "menu", {{"questions", 20}, {"seed", 7}});
  EXPECT_EQ(menu["seed"], 7);
  EXPECT_EQ(menu["version"], done(client, "list", {{"limit", 1}})["version"]);
  ASSERT_FALSE(menu["rows"].empty());
  for (const json& row : menu["rows"]) {
    EXPECT_EQ(row["asked"], 20) << row;
    if (row["method"] != "boxes only") { EXPECT_EQ(row["wrong"], 0) << row; }
    EXPECT_GT(row["p50_ns"], 0) << row;
    EXPECT_GE(row["p99_ns"], row["p50_ns"]) << row;
  }
}

// So each command of the table has a handler.
TEST_F(ServerCommands, EachCommandRefusesAnArgumentThatItDoesNotTake) {
  start();
  Client client = connect();
  for (const auto& spec : wire_contract::command::kCommands) {
    const std::string name = spec.name;
    EXPECT_EQ(refusal(client, name, {{"zzzzzzz", 1}}), "server refused: " + name + ": unknown argument 'zzzzzzz'");
  }
  EXPECT_EQ(refusal(client, "lst", json::object()), "server refused: unknown command 'lst'; did you mean 'list'?");
}

TEST_F(ServerCommands, RefusalsNameWhatIsNear) {
  start();
  Client client = connect();
  EXPECT_EQ(refusal(client, "get", {{"name", "palet_01"}}),
            "server refused: object 'palet_01' is not in the world (31 objects); nearest names: pallet_01, pallet_02, "
            "pallet_03");
  EXPECT_EQ(refusal(client, "move", {{"name", "warehouse/floor"}, {"pose", pose(0, 0, 0)}}),
            "server refused: object 'warehouse/floor' is a part of scene 'warehouse' and stays where it is");
  EXPECT_EQ(refusal(client, "list", {{"nmae", "x"}}),
            "server refused: list: unknown argument 'nmae'; did you mean 'name'?");
  EXPECT_EQ(refusal(client, "load", {{"path", "/nowhere/x.obj"}, {"unit_m", -1}}),
            "server refused: load: unit_m is -1; allowed: greater than 0");
  EXPECT_EQ(refusal(client, "clear", {{"scene", "moon"}}),
            "server refused: scene 'moon' is not loaded; loaded: warehouse");
  EXPECT_NE(refusal(client, "load", {{"path", "/nowhere/x.obj"}}).find("/nowhere/x.obj"), std::string::npos);
}

TEST_F(ServerCommands, ObjectsOfALivePublisherAreItsOwn) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "owner");
  add_ball(publisher, "ball", at(6, 0, 1));
  ASSERT_TRUE(publisher.wait_applied(20s));
  EXPECT_EQ(refusal(client, "remove", {{"name", "ball"}}),
            "server refused: object 'ball' belongs to publisher 'owner', which lives");
  EXPECT_EQ(done(client, "clear", {{"moving", true}})["kept"], 1);
  EXPECT_EQ(done(client, "list", {{"name", "ball"}})["objects"][0]["publisher"], "owner");
}

TEST_F(ServerCommands, ASceneIsLoadedReplacedAndCleared) {
  start();
  Client client = connect();
  const std::string path = folder_.write("roof.obj", "v -9 -9 6\nv 9 -9 6\nv 9 9 6\nv -9 9 6\nf 1 2 3 4\n");
  const json loaded = done(client, "load", {{"path", path}});
  EXPECT_EQ(loaded["scene"], "roof");
  EXPECT_EQ(loaded["triangles"], 2);
  const RayQuestion up{.origin = {6, 0, 1}, .direction = {0, 0, 1}};
  EXPECT_NEAR(client.ask(up)->hits.at(0).distance_m, 5, 1e-12);
  EXPECT_EQ(refusal(client, "load", {{"path", path}}), "server refused: scene 'roof' is loaded already");
  done(client, "load", {{"path", path}, {"unit_m", 0.5}, {"replace", true}});
  EXPECT_NEAR(client.ask(RayQuestion{.origin = {3, 2, 1}, .direction = {0, 0, 1}})->hits.at(0).distance_m, 2, 1e-12);
  done(client, "clear", {{"scene", "roof"}});
  EXPECT_EQ(client.ask(up)->verdict, Verdict::miss);
  // Statuses come twenty times a second.
  const auto until = std::chrono::steady_clock::now() + 5s;
  while (client.status()->scenes.size() > 1 && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(10ms);
  EXPECT_EQ(client.status()->scenes, std::vector<std::string>{"warehouse"});
}

// What replaces a scene is looked at before that scene goes.
TEST_F(ServerCommands, ASceneThatCannotTakeTheOthersPlaceLeavesItThere) {
  start({"--max-objects", "50"});
  Client client = connect();
  const std::string path = folder_.write("roof.obj", "v -9 -9 6\nv 9 -9 6\nv 9 9 6\nv -9 9 6\nf 1 2 3 4\n");
  done(client, "load", {{"path", path}});
  std::string many = "v -9 -9 6\nv 9 -9 6\nv 9 9 6\n";
  for (int i = 0; i < 30; ++i) many += "o part" + std::to_string(i) + "\nf 1 2 3\n";
  folder_.write("roof.obj", many);
  const std::string refused = refusal(client, "load", {{"path", path}, {"replace", true}});
  EXPECT_NE(refused.find("over the limit of 50 (max_objects). Nothing was added"), std::string::npos) << refused;
  EXPECT_NEAR(client.ask(RayQuestion{.origin = {6, 0, 1}, .direction = {0, 0, 1}})->hits.at(0).distance_m, 5, 1e-12);
}

// It has been moved through the floor, which was told then; after a crash it is where it was, and went nowhere.
TEST_F(ServerCommands, WhatComesBackAfterACrashHasNoWayBehindIt) {
  testing_support::ChildProcess& first = start({}, "first");
  Client client = connect();
  done(client, "add", {{"name", "crate"}, {"pose", pose(6, 0, 3)}}, {BoxShape{.half_m = {0.2, 0.2, 0.2}}});
  done(client, "move", {{"name", "crate"}, {"pose", pose(6, 0, -3)}});
  ASSERT_TRUE(test::eventually([&] { return client.status()->last_event_sequence == 2; }))
      << client.status()->last_event_sequence;
  const std::uint64_t epoch = client.status()->epoch;
  first.signal(SIGKILL);
  first.wait(10s);
  start({}, "second");
  ASSERT_TRUE(
      test::eventually([&] { return client.status()->epoch > epoch && client.status()->state == "ready"; }, 20s));
  EXPECT_EQ(done(client, "get", {{"name", "crate"}})["pose"], pose(6, 0, -3));
  EXPECT_EQ(client.status()->last_event_sequence, 0U);
}

// Their names have 4,095 bytes in a status; what has no room is left out by whole names, and "..." says so.
TEST_F(ServerCommands, TheStatusNamesAsManyScenesAsHaveRoom) {
  constexpr std::size_t kRoom = 4'095;
  start();
  Client client = connect();
  const std::string path = folder_.write("roof.obj", "v -9 -9 6\nv 9 -9 6\nv 9 9 6\nf 1 2 3\n");
  std::vector<std::string> expected{"warehouse"};
  std::size_t bytes = expected[0].size();
  const auto load = [&](std::size_t length) {
    const std::string name = std::string(length - 3, 'n') + std::to_string(100 + expected.size());
    done(client, "load", {{"path", path}, {"name", name}});
    expected.push_back(name);
    bytes += 1 + length;
  };
  const auto told = [&](const std::vector<std::string>& names) {
    return test::eventually([&] { return client.status()->scenes == names; });
  };
  while (bytes + 251 <= kRoom) load(250);
  load(kRoom - bytes - 1);
  EXPECT_EQ(bytes, kRoom);
  EXPECT_TRUE(told(expected)) << "all, to the last byte";
  expected.pop_back();
  const std::string last = client.status()->scenes.back();
  done(client, "clear", {{"scene", last}});
  ASSERT_TRUE(told(expected));
  const std::string one_more = last + "x";
  done(client, "load", {{"path", path}, {"name", one_more}});
  std::vector<std::string> fitting = expected;
  fitting.push_back("...");
  EXPECT_TRUE(told(fitting)) << client.status()->scenes.size();
}

TEST_F(ServerCommands, ListCountsAndPlanExplains) {
  start();
  Client client = connect();
  const json some = done(client, "list", {{"name", "pallet_*"}, {"limit", 2}});
  EXPECT_EQ(some["count"], 6);
  EXPECT_EQ(some["objects"].size(), 2U);
  EXPECT_EQ(done(client, "list", {{"moving", true}})["count"], 0);
  const json plan = done(client, "plan", json::object());
  EXPECT_GT(plan["structures"].size(), 3U);
  EXPECT_GT(plan["pairs"].size(), 5U);
  std::map<std::string, bool> in_use;
  for (const json& wing : plan["wings"]) in_use[wing["name"]] = wing["in_use"];
  EXPECT_TRUE(in_use.at("flight recorder"));
  EXPECT_FALSE(in_use.at("keys"));
  EXPECT_FALSE(in_use["fleet"] || in_use["authority"]) << "a server alone";
  EXPECT_EQ(done(client, "figures", json::object())["wings"], plan["wings"]);
}

}  // namespace
}  // namespace collided
