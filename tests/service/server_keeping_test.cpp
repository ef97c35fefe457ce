// What a server has acknowledged is there after a stop and after a kill, or its loss is reported and nothing is called free
// until the loss is accepted.
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iterator>
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
  void stop() {
    servers_.back()->signal(SIGTERM);
    EXPECT_EQ(servers_.back()->wait(15s), 0) << servers_.back()->errors();
  }
  void stop_and_start(const std::vector<std::string>& options = {}) {
    stop();
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

/// A world with something of each kind that is kept, as the commands that make it.
class ServerKeepingAll : public ServerKeeping {
 protected:
  static void make_world(Client& client) {
    const Shape ball{SphereShape{.radius_m = 0.2}};
    done(client, "load", {{"path", "embedded:"}});
    done(client, "remove", {{"name", "warehouse/wall_north"}});
    done(client, "add", {{"name", "crate"}, {"pose", {70, 0, 9, 1, 0, 0, 0}}}, ball);
    done(client, "add", {{"name", "lid"}, {"pose", {80, 0, 9.5, 1, 0, 0, 0}}}, ball);
    done(client, "move", {{"name", "crate"}, {"pose", {80, 0, 9, 1, 0, 0, 0}}});
    done(client, "attach", {{"child", "lid"}, {"parent", "crate"}});
    done(client, "allow", {{"a", "crate"}, {"b", "lid"}, {"because", "a joint"}});
    done(client, "probe", {{"name", "front"}, {"object", "crate"}, {"direction", {0, 0, 1}}, {"reach_m", 10}});
    done(client, "fence", {{"name", "close"}, {"keep", true}, {"only", "*"}, {"to", "crate"}, {"within", 5}});
  }
  /// What a client can ask about that world, as text that is the same for the same world.
  static std::string description(Client& client) {
    json all{{"names", names(client, "*")}};
    for (const double x : {0.0, 70.0, 80.0}) all["below"].push_back(std::string(name_of(below(client, x).verdict)));
    all["lid"] = done(client, "get", {{"name", "lid"}}).value("pose", json());
    all["rules"] = done(client, "allowed", json::object())["rules"];
    const json probes = done(client, "probes", json::object())["probes"];
    for (const json& probe : probes) all["probes"].push_back(probe["probe"]);
    const json standing = done(client, "fences", json::object())["standing"];
    for (const json& row : standing) all["standing"].push_back(row["name"]);
    // It goes along, so it is attached.
    done(client, "move", {{"name", "crate"}, {"pose", {80, 1, 9, 1, 0, 0, 0}}});
    all["lid moved"] = done(client, "get", {{"name", "lid"}}).value("pose", json());
    done(client, "move", {{"name", "crate"}, {"pose", {80, 0, 9, 1, 0, 0, 0}}});
    return all.dump(1);
  }
};

TEST_F(ServerKeepingAll, TheWorldIsTheSameAfterStopsAndKillsInAnyOrder) {
  const std::string hall = folder_.write("hall.obj", kHall);
  start({hall});
  std::string before;
  {
    Client client = connect();
    make_world(client);
    before = description(client);
    EXPECT_EQ(before.find("wall_north"), std::string::npos) << before;
    EXPECT_NE(before.find("\"close\""), std::string::npos) << before;
  }
  for (const bool is_stop : {true, true, false, true}) {
    is_stop ? stop_and_start({hall}) : kill_and_start({hall});
    Client client = connect();
    // After a stop nothing is waited for, so whoever has read the ready line may ask; after a kill publishers may come back.
    if (is_stop) {
      EXPECT_EQ(client.status()->state, "ready") << servers_.back()->errors();
    } else {
      ASSERT_TRUE(becomes(client, "ready")) << servers_.back()->errors();
    }
    EXPECT_EQ(description(client), before) << (is_stop ? "after a stop" : "after a kill");
    const std::string log = servers_.back()->errors();
    EXPECT_EQ(log.find("did not end in order") == std::string::npos, is_stop) << log;
    EXPECT_EQ(log.find("lost: "), std::string::npos) << log;
    EXPECT_EQ(log.find("cannot be carried out again"), std::string::npos) << log;
  }
  stop_and_start({hall, "--fresh"});
  Client client = connect();
  EXPECT_EQ(names(client, "*"), (Names{"hall/door", "hall/wall"}));
  EXPECT_NE(servers_.back()->errors().find("--fresh: what was kept is dropped: 1 scenes, 1 removed parts, 2 objects"),
            std::string::npos)
      << servers_.back()->errors();
}

TEST_F(ServerKeepingAll, AStopWhileTheWorldIsRestoredLosesNothing) {
  const std::string hall = folder_.write("hall.obj", kHall);
  start({hall});
  std::string before;
  {
    Client client = connect();
    make_world(client);
    before = description(client);
  }
  for (int round = 0; round < 3; ++round) {
    stop();
    launch({hall}, "stopped early " + std::to_string(round));
    // Its own scene is there; what was kept is still to be carried out.
    ASSERT_TRUE(servers_.back()->says("hall: ", 15s)) << servers_.back()->errors();
  }
  stop_and_start({hall});
  Client client = connect();
  EXPECT_EQ(client.status()->state, "ready") << servers_.back()->errors();
  EXPECT_EQ(description(client), before);
}

TEST_F(ServerKeepingAll, WhatIsClearedStaysAwayAfterAStop) {
  const std::string hall = folder_.write("hall.obj", kHall);
  start({hall});
  {
    Client client = connect();
    make_world(client);
    done(client, "clear", json::object());
  }
  stop_and_start({hall});
  {
    Client client = connect();
    ASSERT_TRUE(becomes(client, "ready"));
    EXPECT_EQ(names(client, "*"), Names{}) << "the scene of the start options, too";
    done(client, "load", {{"path", hall}});
  }
  stop_and_start({hall});
  Client client = connect();
  ASSERT_TRUE(becomes(client, "ready"));
  EXPECT_EQ(names(client, "*"), (Names{"hall/door", "hall/wall"}));
}

// A folder that the first server of this layout wrote. COLLIDED_STORE_STATE=1 writes it anew, for a new layout.
TEST_F(ServerKeepingAll, AStoredFolderIsReadByThisVersion) {
  const std::string hall = folder_.write("hall.obj", kHall);
  const std::string stored = COLLIDED_SOURCE_DIR "/tests/service/stored/journal_4.hex";
  const auto start_without_recovery = [&] {
    start({hall}, "server " + std::to_string(servers_.size()));
    Client client = connect();
    EXPECT_TRUE(becomes(client, "ready")) << servers_.back()->errors();
    return description(client);
  };
  std::string expected;
  {
    start({hall});
    Client client = connect();
    make_world(client);
    expected = description(client);
  }
  stop();
  if (std::getenv("COLLIDED_STORE_STATE") != nullptr) {
    std::ifstream in(journal(), std::ios::binary);
    std::ofstream out(stored);
    int column = 0;
    out << std::hex << std::setfill('0');
    for (std::istreambuf_iterator<char> byte(in), end; byte != end; ++byte)
      out << std::setw(2) << +static_cast<unsigned char>(*byte) << (++column % 60 == 0 ? "\n" : "");
    out << '\n';
  }
  std::ifstream hex(stored);
  std::string bytes;
  for (char high = 0, low = 0; hex >> high >> low;)
    bytes += static_cast<char>(std::stoi(std::string{high, low}, nullptr, 16));
  ASSERT_GT(bytes.size(), 1'000U);
  std::ofstream(journal(), std::ios::binary | std::ios::trunc) << bytes;
  EXPECT_EQ(start_without_recovery(), expected);
  EXPECT_EQ(servers_.back()->errors().find("lost: "), std::string::npos) << servers_.back()->errors();
}

// What another version wrote is neither read nor lost.
TEST_F(ServerKeeping, AFolderOfAnotherVersionIsRefusedUnlessAFreshStartIsAskedFor) {
  start();
  stop();
  std::fstream(journal(), std::ios::in | std::ios::out | std::ios::binary).write("collided journal 3\n", 19);
  const Ended refused = run({"--domain", std::to_string(domain_), "--state-dir", folder_.path()});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.errors.find(journal() + ": its layout is 3, and this version reads layout 4. Nothing was started"),
            std::string::npos)
      << refused.errors;
  EXPECT_NE(refused.errors.find("collided --fresh drops"), std::string::npos) << refused.errors;
  start({"--fresh"}, "fresh");
}

// The publisher of the parent may be started much later, and nothing waits for it.
TEST_F(ServerKeeping, AnAttachmentToAPublishersObjectHoldsAgainOnceThatIsThere) {
  start();
  {
    Client client = connect();
    Publisher publisher = publish(client, "driver");
    add_ball(publisher, "truck", at(60, 0, 9));
    ASSERT_TRUE(publisher.wait_applied(20s));
    add(client, "crate", 60.5);
    done(client, "attach", {{"child", "crate"}, {"parent", "truck"}});
    stop();
  }
  start({}, "again");
  Client client = connect();
  ASSERT_TRUE(becomes(client, "ready")) << "nothing is missing that was kept";
  EXPECT_EQ(names(client, "*crate"), Names{"crate"});
  Publisher publisher = publish(client, "driver");
  const Publisher::Object truck = add_ball(publisher, "truck", at(60, 0, 9));
  ASSERT_TRUE(publisher.wait_applied(20s));
  // A tenth of a second may pass before it is attached: then it keeps its place beside the truck.
  const auto y = [&] { return done(client, "get", {{"name", "crate"}})["pose"].at(1).get<double>(); };
  double way = 0;
  EXPECT_TRUE(test::eventually(
      [&] {
        move(publisher, truck, at(60, ++way, 9));
        return publisher.wait_applied(20s) && y() == way;
      },
      60s));
}

TEST_F(ServerKeeping, AnAttachmentThatWaitsForItsParentIsGivenUpByDetach) {
  start();
  {
    Client client = connect();
    add(client, "crate", 60.5);
    Publisher publisher = publish(client, "driver");
    add_ball(publisher, "other truck", at(62, 0, 9));
    ASSERT_TRUE(publisher.wait_applied(20s));
    done(client, "attach", {{"child", "crate"}, {"parent", "other truck"}});
    stop();
  }
  start({}, "again");
  Client client = connect();
  ASSERT_TRUE(becomes(client, "ready"));
  EXPECT_EQ(done(client, "detach", {{"child", "crate"}})["parent"], "other truck");
  EXPECT_FALSE(client.command("detach", R"({"child":"crate"})")) << "once";
  stop_and_start();
  Client other = connect();
  ASSERT_TRUE(becomes(other, "ready"));
  EXPECT_FALSE(other.command("detach", R"({"child":"crate"})"));
}

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

  EXPECT_NE(server.errors().find("nothing is kept: what commands do is lost when the server ends"), std::string::npos)
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
  EXPECT_NE(collide({"status", "--table"}).first.find("keeps nothing: what commands do is lost when the server ends"),
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
