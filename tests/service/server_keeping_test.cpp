// What a server has acknowledged is there after a kill, or its loss is told and nothing is called free until somebody
// accepts it.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing_support::ChildProcess;

class ServerKeeping : public testing_support::ServerTest {
 protected:
  static constexpr const char* kHall =
      "v 50 0 0\nv 51 0 0\nv 50 1 0\no door\nf 1 2 3\nv 60 0 0\nv 61 0 0\nv 60 1 0\no wall\nf 4 5 6\n";

  void kill_and_start(const std::vector<std::string>& options = {}) {
    servers_.back()->signal(SIGKILL);
    servers_.back()->wait(5s);
    start(options, "server " + std::to_string(servers_.size()));
  }
  static bool becomes(Client& client, const std::string& state) {
    return test::eventually([&] { return client.status() && client.status()->state == state; }, 15s);
  }
  static json done(Client& client, const std::string& command, const json& arguments, const Shape& shape = {}) {
    const Result<std::string> answer = client.command(command, arguments.dump(), shape);
    EXPECT_TRUE(answer) << answer.error().message;
    return answer ? json::parse(*answer) : json();
  }
  static json add(Client& client, const std::string& name, double x) {
    return done(client, "add", {{"name", name}, {"pose", {x, 0, 9, 1, 0, 0, 0}}}, {SphereShape{.radius_m = 0.2}});
  }
  /// What is below (x, 0.2, 12).
  static Answer below(Client& client, double x) {
    return *client.ask(RayQuestion{.origin = {x, 0.2, 12}, .direction = {0, 0, -1}});
  }
  static std::vector<std::string> names(Client& client, const std::string& glob) {
    std::vector<std::string> found;
    const Result<ObjectList> list = client.list({.name = glob});
    if (!list) return {list.error().message};
    for (const ListedObject& object : list->objects) found.push_back(object.name);
    std::sort(found.begin(), found.end());
    return found;
  }
  std::string journal() const { return folder_.path() + "/" + std::to_string(domain_) + "-collided.journal"; }
  std::string epoch() const { return folder_.path() + "/" + std::to_string(domain_) + "-collided.epoch"; }
};

using Names = std::vector<std::string>;

// What may touch is still no contact after a kill, in the order in which rules were given.
TEST_F(ServerKeeping, RulesOfWhatMayTouchOutliveAKill) {
  start();
  const json expected = json::parse(R"([{"a":"left","allows":true,"b":"right","because":"a joint"},
                                        {"a":"left","allows":false,"b":"*","because":""},
                                        {"a":"x*","allows":true,"b":"y*","because":""}])");
  {
    Client client = connect();
    add(client, "left", 70);
    add(client, "right", 70.1);
    EXPECT_EQ(done(client, "allow", {{"a", "gone"}, {"b", "gone"}})["rules"], 1);
    const json allowed = done(client, "allow", {{"a", "left"}, {"b", "right"}, {"because", "a joint"}});
    EXPECT_EQ(allowed["ended"], 1);
    EXPECT_EQ(allowed["a_count"], 1);
    done(client, "deny", {{"a", "gone"}, {"b", "gone"}});
    EXPECT_EQ(done(client, "deny", {{"a", "left"}, {"b", "*"}})["began"], 1);
    done(client, "allow", {{"a", "x*"}, {"b", "y*"}});
  }
  for (int kill = 0; kill < 2; ++kill) {
    kill_and_start();
    Client client = connect();
    ASSERT_TRUE(becomes(client, "ready"));
    json rules = done(client, "allowed", json::object())["rules"];
    std::erase_if(rules.get_ref<json::array_t&>(), [](const json& rule) { return rule["a"] == "gone"; });
    EXPECT_EQ(rules, expected) << "kill " << kill;
    EXPECT_EQ(client.get("left")->contacts.size(), 1u);
  }
}

TEST_F(ServerKeeping, WhatWasRemovedStaysAwayAndWhatWasMovedStaysThere) {
  const std::string hall = folder_.write("hall.obj", kHall);
  const std::string shed = folder_.write("shed.obj", kHall);
  start({hall, shed});
  {
    Client client = connect();
    done(client, "load", {{"path", hall}, {"name", "loaded"}});
    add(client, "crate", 70);
    add(client, "gone", 71);
    done(client, "remove", {{"name", "gone"}});
    done(client, "remove", {{"name", "loaded/door"}});
    done(client, "remove", {{"name", "hall/wall"}});
    done(client, "clear", {{"scene", "shed"}});
    done(client, "move", {{"name", "crate"}, {"pose", {80, 0, 9, 1, 0, 0, 0}}});
  }
  for (int kill = 0; kill < 2; ++kill) {
    kill_and_start({hall, shed});
    Client client = connect();
    ASSERT_TRUE(becomes(client, "ready"));
    EXPECT_EQ(names(client, "*"), (Names{"crate", "hall/door", "loaded/wall"})) << "kill " << kill;
    EXPECT_EQ(below(client, 80).verdict, Verdict::hit);
    EXPECT_EQ(below(client, 70).verdict, Verdict::miss);
  }
  Client client = connect();
  done(client, "load", {{"path", hall}, {"name", "loaded"}, {"replace", true}});
  kill_and_start({hall, shed});
  Client other = connect();
  ASSERT_TRUE(becomes(other, "ready"));
  EXPECT_EQ(names(other, "loaded/*"), (Names{"loaded/door", "loaded/wall"})) << "it was loaded anew since";
}

TEST_F(ServerKeeping, ADamagedEpochLosesNothing) {
  start();
  {
    Client client = connect();
    add(client, "crate", 70);
  }
  for (const std::string& path : {epoch(), epoch() + ".copy"}) {
    std::ofstream(path, std::ios::trunc) << "17";
    kill_and_start();
    Client client = connect();
    ASSERT_TRUE(becomes(client, "ready"));
    EXPECT_EQ(below(client, 70).verdict, Verdict::hit);
  }
  std::filesystem::remove(epoch());
  std::filesystem::remove(epoch() + ".copy");
  kill_and_start();
  Client client = connect();
  ASSERT_TRUE(becomes(client, "ready"));
  EXPECT_EQ(below(client, 70).verdict, Verdict::hit) << "the journal says itself that nobody closed it";
}

TEST_F(ServerKeeping, WhatADamagedJournalLostIsToldAndNothingIsFreeUntilThatIsAccepted) {
  start();
  {
    Client client = connect();
    add(client, "crate", 70);
    add(client, "box", 71);
  }
  std::filesystem::resize_file(journal(), std::filesystem::file_size(journal()) - 7);
  for (int kill = 0; kill < 2; ++kill) {
    kill_and_start();
    EXPECT_NE(servers_.back()->errors().find("until somebody says: collide accept-loss"), std::string::npos)
        << servers_.back()->errors();
    Client client = connect();
    EXPECT_FALSE(test::eventually([&] { return client.status()->state == "ready"; }, 4s)) << "kill " << kill;
    EXPECT_EQ(below(client, 71).reason, UndecidedReason::recovering);
    EXPECT_EQ(names(client, "crate"), Names{"crate"}) << "what is there is there";
    EXPECT_EQ(done(client, "accept_loss", {{"show", true}})["losses"].size(), 1u);
  }
  Client client = connect();
  const json accepted = done(client, "accept_loss", json::object());
  EXPECT_NE(accepted["losses"].at(0).get<std::string>().find("were acknowledged"), std::string::npos) << accepted;
  EXPECT_EQ(accepted["accepted"], true);
  EXPECT_TRUE(becomes(client, "ready"));
  EXPECT_EQ(below(client, 71).verdict, Verdict::miss);
  kill_and_start();
  Client other = connect();
  EXPECT_TRUE(becomes(other, "ready")) << "accepted once and for all";
  EXPECT_EQ(names(other, "crate"), Names{"crate"});
}

TEST_F(ServerKeeping, AMissingJournalAndAMissingFileAreLosses) {
  start();
  {
    Client client = connect();
    const std::string hall = folder_.write("hall.obj", kHall);
    done(client, "load", {{"path", hall}});
    std::filesystem::remove(hall);
  }
  kill_and_start();
  {
    Client client = connect();
    ASSERT_TRUE(test::eventually([&] { return !done(client, "accept_loss", {{"show", true}})["losses"].empty(); }, 5s));
    EXPECT_EQ(client.status()->state, "recovering");
    done(client, "load", {{"path", folder_.write("hall.obj", kHall)}});
    EXPECT_TRUE(becomes(client, "ready")) << "it is there again: nothing is missing any more";
  }
  std::filesystem::remove(journal());
  kill_and_start();
  Client client = connect();
  const json losses = done(client, "accept_loss", json::object())["losses"];
  ASSERT_EQ(losses.size(), 1u);
  EXPECT_NE(losses[0].get<std::string>().find("is missing"), std::string::npos) << losses;
  EXPECT_TRUE(becomes(client, "ready"));
}

TEST_F(ServerKeeping, AnUploadThatChangedOnTheDiskIsALoss) {
  start();
  {
    Client client = connect();
    const std::string_view text(kHall);
    ASSERT_TRUE(client.upload(std::as_bytes(std::span(text)), "hall.obj"));
  }
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) {
    if (entry.path().filename() != "hall.obj") continue;
    std::fstream file(entry.path(), std::ios::in | std::ios::out);
    file.seekp(2);
    file << "4";
  }
  kill_and_start();
  Client client = connect();
  ASSERT_TRUE(test::eventually([&] { return !done(client, "accept_loss", {{"show", true}})["losses"].empty(); }, 5s));
  EXPECT_EQ(names(client, "hall/*"), Names{});
  EXPECT_EQ(client.status()->state, "recovering");
}

// Nothing can be written at all: what is done is done, and the answer says that it does not last. People are told once,
// at the start, and whoever looks.
TEST_F(ServerKeeping, WhatIsNotKeptIsToldAndRefusedWhereItMustBe) {
  ChildProcess server({COLLIDED_SERVER, "--domain", std::to_string(domain_), "--state-dir", "/proc/1/nothing"},
                      folder_.path(), "keeps_nothing");
  ASSERT_TRUE(server.says("ready:", 20s)) << server.errors();
  Client client = connect();
  EXPECT_NE(add(client, "crate", 70).value("not_kept", ""), "");
  const Result<Added> added = client.add({.name = "box", .shape = {SphereShape{.radius_m = 0.2}}});
  ASSERT_TRUE(added);
  EXPECT_NE(added->not_kept, "");
  const json arguments{{"name", "safe"}, {"durable", true}};
  const Result<std::string> refused = client.command("add", arguments.dump(), {SphereShape{.radius_m = 0.2}});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("it cannot be kept"), std::string::npos) << refused.error().message;
  EXPECT_EQ(names(client, "safe"), Names{});
  EXPECT_EQ(names(client, "crate"), Names{"crate"});

  EXPECT_NE(server.errors().find("nothing is kept: what commands do is lost with a crash"), std::string::npos)
      << server.errors();
  const auto collide = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all{COLLIDED_CLI, "--domain", std::to_string(domain_)};
    all.insert(all.end(), words.begin(), words.end());
    ChildProcess process(all, folder_.path(), "collide");
    EXPECT_EQ(process.wait(20s), 0) << process.errors();
    return std::pair(process.output(), process.errors());
  };
  const auto [added_line, warned] = collide({"add", "ball", "sphere", "0.1", "--json"});
  EXPECT_EQ(warned, "") << "not with every command";
  EXPECT_NE(json::parse(added_line).value("not_kept", ""), "") << added_line;
  EXPECT_NE(collide({"status", "--table"}).first.find("keeps nothing: what commands do is lost with a crash"),
            std::string::npos);
  EXPECT_EQ(json::parse(collide({"status", "--json"}).first).value("keeps_nothing", false), true);
  EXPECT_NE(collide({"plan", "--table"}).first.find("left out  journal: no folder to keep it in"), std::string::npos);
}

TEST_F(ServerKeeping, AServerThatKeepsDoesNotSayThatItDoesNot) {
  start();
  Client client = connect();
  const json added = add(client, "crate", 70);
  EXPECT_FALSE(added.contains("not_kept") || added.contains("keeps_nothing")) << added;
  EXPECT_EQ(done(client, "figures", json::object()).value("keeps_nothing", true), false);
  EXPECT_EQ(done(client, "plan", json::object()).dump().find("journal"), std::string::npos);
}

}  // namespace
}  // namespace collided
