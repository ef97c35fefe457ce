// A standby takes the place of a primary that fails: the world, its contacts and its events go on.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "collided/commands.hpp"
#include "collided/fleet.hpp"
#include "collided/recording.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using testing_support::ChildProcess;
using testing_support::ScratchFolder;

class ServerTakeover : public testing_support::ServerTest {
 protected:
  /// A server with a state folder of its own. A crowded machine makes one that lives seem silent for as long as 200 ms.
  ChildProcess& join(const std::string& name, bool stands_by, std::vector<std::string> more = {}) {
    std::vector<std::string> words{COLLIDED_SERVER,
                                   "--domain",
                                   std::to_string(domain_),
                                   "--member",
                                   name,
                                   "--state-dir",
                                   folder_.path() + "/" + name,
                                   "--take-over-after",
                                   "2s"};
    if (stands_by) words.insert(words.end(), {"--standby-of", "collided"});
    words.insert(words.end(), more.begin(), more.end());
    servers_.push_back(std::make_unique<ChildProcess>(words, folder_.path(), name));
    EXPECT_TRUE(servers_.back()->says("ready:", 20s)) << servers_.back()->errors();
    return *servers_.back();
  }
  FleetMember member(const std::string& name) {
    const Result<Fleet> all = fleet({.domain = domain_});
    if (!all) return {};
    for (const FleetMember& one : all->members)
      if (one.name == name) return one;
    return {};
  }
  bool becomes_ready(const std::string& name, Publisher& publisher) {
    return test::eventually(
        [&] {
          static_cast<void>(publisher.keep_alive());
          const FleetMember one = member(name);
          return one.state == "ready" && one.hash_time != 0s;
        },
        40s);
  }
  bool becomes_primary(const std::string& name) {
    return test::eventually([&] { return member(name).role == FleetRole::primary; }, 30s);
  }
  /// The newest event within 20 s: what is not told until the place is taken comes late.
  static std::string told(Watch& watching) {
    const Event event = next(watching, 20s);
    return std::string(event.kind == EventKind::began ? "began" : "ended") + (event.resync ? " resync" : "");
  }
};

TEST_F(ServerTakeover, WhatWasOpenStaysOpenAndWhatHappenedMeanwhileIsToldOnce) {
  ChildProcess& primary = join("north", false);
  Client client = connect();
  Publisher publisher = publish(client, "balls");
  add_ball(publisher, "post", at(0, 0, 9));
  const auto resting = add_ball(publisher, "resting", at(3, 0, 9));
  const auto mover = add_ball(publisher, "mover", at(1, 0, 9));
  add_ball(publisher, "other post", at(3, 0, 9.15));
  join("south", true);
  Watch watching = watch(client);
  ASSERT_EQ(next(watching).kind, EventKind::open);
  ASSERT_TRUE(becomes_ready("south", publisher)) << servers_.back()->errors();
  move(publisher, mover, at(0.15, 0, 9));
  EXPECT_EQ(told(watching), "began");
  primary.signal(SIGKILL);
  for (int i = 0; i < 3; ++i) {
    move(publisher, mover, at(1, 0, 9));
    move(publisher, mover, at(0.15, 0, 9));
  }
  std::vector<std::string> events;
  for (int i = 0; i < 6; ++i) events.push_back(told(watching));
  EXPECT_EQ(events, (std::vector<std::string>{"ended", "began", "ended", "began", "ended", "began"}));
  move(publisher, resting, at(4, 0, 9));
  const Event ended = next(watching);
  EXPECT_EQ(ended.kind, EventKind::ended);
  EXPECT_TRUE(ended.a == "resting" || ended.b == "resting");
  EXPECT_FALSE(ended.resync);
  EXPECT_FALSE(watching.next(300ms)) << "nothing is told twice";
  EXPECT_TRUE(becomes_primary("south"));
  EXPECT_NE(servers_.back()->errors().find("'north' has been silent for 2"), std::string::npos)
      << servers_.back()->errors();
  EXPECT_NE(servers_.back()->errors().find("this server has taken its place, as epoch "), std::string::npos);
}

TEST_F(ServerTakeover, QuestionsAndCommandsGoToTheOneThatTookThePlace) {
  ChildProcess& primary = join("north", false);
  Client client = connect();
  Publisher publisher = publish(client, "nobody");
  join("south", true);
  ASSERT_TRUE(
      client.command("add", R"({"name": "crate", "pose": [3, 0, 9, 1, 0, 0, 0]})", {SphereShape{.radius_m = 0.3}}, 5s));
  ASSERT_TRUE(becomes_ready("south", publisher)) << servers_.back()->errors();
  const RayQuestion ray{.origin = {0, 0, 9}, .direction = {1, 0, 0}, .length_m = 100};
  ASSERT_EQ(client.ask(ray)->verdict, Verdict::hit);
  primary.signal(SIGKILL);
  // Without an answer it is said that the server is silent, and never that there is no hit.
  std::vector<std::string> wrong;
  EXPECT_TRUE(test::eventually(
      [&] {
        const Result<Answer> answer = client.ask(ray, {.timeout = 5s});
        if (answer && (answer->verdict != Verdict::hit || answer->hits.empty() || answer->hits[0].object != "crate"))
          wrong.push_back("not the crate");
        if (!answer && answer.error().code != ErrorCode::disconnected) wrong.push_back(answer.error().message);
        return static_cast<bool>(answer);
      },
      20s));
  EXPECT_EQ(wrong, std::vector<std::string>{});
  ASSERT_TRUE(client.command("move", R"({"name": "crate", "pose": [5, 0, 9, 1, 0, 0, 0]})", {}, 5s));
  EXPECT_NEAR(client.ask(ray)->hits.at(0).distance_m, 4.7, 1e-9);

  // What it was told while it stood by is in its recordings.
  const std::string file = folder_.path() + "/south.mcap";
  ASSERT_TRUE(fetch_recording({.domain = domain_}, 0s, file));
  {
    ChildProcess another({COLLIDED_SERVER, "--domain", std::to_string(domain_), "--namespace", "again", "--state-dir",
                          folder_.path() + "/another"},
                         folder_.path(), "another");
    ASSERT_TRUE(another.says("ready:", 20s)) << another.errors();
    const ConnectOptions there{.domain = domain_, .name_space = "again"};
    ASSERT_TRUE(replay(there, {.path = file}));
    EXPECT_NEAR(Client::connect(there)->ask(ray)->hits.at(0).distance_m, 4.7, 1e-9);
  }

  // It can be followed in turn, and what it was told outlives it too.
  join("west", true);
  ASSERT_TRUE(becomes_ready("west", publisher)) << servers_.back()->errors();
  servers_[1]->signal(SIGKILL);
  EXPECT_TRUE(becomes_primary("west")) << servers_.back()->errors();
  EXPECT_TRUE(test::eventually([&] {
    const Result<Answer> answer = client.ask(ray, {.timeout = 5s});
    return answer && answer->verdict == Verdict::hit && std::abs(answer->hits.at(0).distance_m - 4.7) < 1e-9;
  }));
}

TEST_F(ServerTakeover, APrimaryThatWasStoppedAndGoesOnGivesWay) {
  ChildProcess& primary = join("north", false);
  Client client = connect();
  Publisher publisher = publish(client, "balls");
  add_ball(publisher, "post", at(0, 0, 9));
  const auto mover = add_ball(publisher, "mover", at(1, 0, 9));
  join("south", true);
  Watch watching = watch(client);
  ASSERT_TRUE(becomes_ready("south", publisher)) << servers_.back()->errors();
  primary.signal(SIGSTOP);
  ASSERT_TRUE(becomes_primary("south")) << servers_.back()->errors();
  move(publisher, mover, at(0.15, 0, 9));
  const Event began = next(watching, 20s);
  EXPECT_EQ(began.epoch, member("south").epoch);
  primary.signal(SIGCONT);
  EXPECT_EQ(primary.wait(20s), 3);
  EXPECT_NE(primary.errors().find("has taken this server's place"), std::string::npos) << primary.errors();
  move(publisher, mover, at(1, 0, 9));
  const Event ended = next(watching);
  EXPECT_EQ(ended.kind, EventKind::ended);
  EXPECT_EQ(ended.epoch, began.epoch);
  EXPECT_FALSE(watching.next(300ms));
}

TEST_F(ServerTakeover, HandingOverLosesNothingAndEndsTheOneThatHandsOver) {
  ChildProcess& primary = join("north", false);
  Client client = connect();
  Publisher publisher = publish(client, "balls");
  add_ball(publisher, "post", at(0, 0, 9));
  const auto mover = add_ball(publisher, "mover", at(1, 0, 9));
  const Result<std::string> alone = client.command("handover", "{}", {}, 5s);
  ASSERT_FALSE(alone);
  EXPECT_EQ(alone.error().message, "server refused: no server stands by that is ready. Nothing was done");
  join("south", true);
  Watch watching = watch(client);
  ASSERT_TRUE(becomes_ready("south", publisher)) << servers_.back()->errors();
  move(publisher, mover, at(0.15, 0, 9));
  EXPECT_EQ(told(watching), "began");
  EXPECT_FALSE(client.command("handover", R"({"to": "nobody"})", {}, 5s));
  const Result<std::string> answer = client.command("handover", R"({"to": "south"})", {}, 5s);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_NE(answer->find(R"("to":"south")"), std::string::npos) << *answer;
  // Meanwhile it moves on, and questions wait for whoever answers.
  const RayQuestion ray{.origin = {0, 0, 20}, .direction = {0, 0, -1}, .length_m = 100};
  for (int i = 0; i < 10; ++i) {
    move(publisher, mover, at(1, 0, 9));
    const Result<Answer> hit = client.ask(ray, {.timeout = 20s});
    ASSERT_TRUE(hit) << hit.error().message;
    EXPECT_EQ(hit->verdict, Verdict::hit);
    move(publisher, mover, at(0.15, 0, 9));
  }
  EXPECT_EQ(primary.wait(20s), 0) << primary.errors();
  EXPECT_NE(primary.errors().find("'south' has this server's place"), std::string::npos) << primary.errors();
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(told(watching), "ended");
    EXPECT_EQ(told(watching), "began");
  }
  EXPECT_FALSE(watching.next(300ms));
  EXPECT_EQ(member("south").role, FleetRole::primary);
}

TEST_F(ServerTakeover, WhereNobodyTakesThePlaceTheServerGoesOnAndCanBeEnded) {
  ChildProcess& primary = join("north", false);
  Client client = connect();
  Publisher publisher = publish(client, "nobody");
  ChildProcess& standby = join("south", true);
  ASSERT_TRUE(becomes_ready("south", publisher)) << standby.errors();
  standby.signal(SIGSTOP);  // for a moment it counts as ready
  ASSERT_TRUE(client.command("handover", "{}", {}, 5s));
  // Asked while it is open who answers.
  const RayQuestion ray{.origin = {0, 0, 20}, .direction = {0, 0, -1}, .length_m = 100};
  const Result<Answer> held = client.ask(ray, {.timeout = 20s});
  EXPECT_TRUE(held) << held.error().message;
  EXPECT_TRUE(test::eventually(
      [&] { return primary.errors().find("has not taken this server's place within 3 s") != std::string::npos; }, 20s))
      << primary.errors();
  standby.signal(SIGKILL);
  primary.signal(SIGTERM);
  EXPECT_EQ(primary.wait(20s), 0) << primary.errors();
}

TEST_F(ServerTakeover, ASignalToEndHandsOverToo) {
  ChildProcess& primary = join("north", false);
  Client client = connect();
  Publisher publisher = publish(client, "balls");
  add_ball(publisher, "post", at(0, 0, 9));
  const auto mover = add_ball(publisher, "mover", at(0.15, 0, 9));
  join("south", true);
  Watch watching = watch(client);
  ASSERT_EQ(next(watching).kind, EventKind::open);
  ASSERT_TRUE(becomes_ready("south", publisher)) << servers_.back()->errors();
  primary.signal(SIGTERM);
  EXPECT_EQ(primary.wait(20s), 0) << primary.errors();
  EXPECT_EQ(member("south").role, FleetRole::primary);
  EXPECT_FALSE(watching.next(300ms)) << "what held goes on";
  move(publisher, mover, at(1, 0, 9));
  EXPECT_EQ(told(watching), "ended");
}

// As under a supervisor: each is started again in the same way when it ends.
/// As Ctrl-C does it with both in one terminal: the place is handed to a standby that is ending, too.
TEST_F(ServerTakeover, APairThatIsEndedAtOnceEndsInOrder) {
  for (int round = 0; round < 4; ++round) {
    SCOPED_TRACE(round);
    ChildProcess& primary = join("north" + std::to_string(round), false);
    Client client = connect();
    Publisher publisher = publish(client, "nobody");
    ChildProcess& standby = join("south" + std::to_string(round), true);
    ASSERT_TRUE(becomes_ready("south" + std::to_string(round), publisher)) << standby.errors();
    primary.signal(SIGTERM);
    standby.signal(SIGTERM);
    EXPECT_EQ(primary.wait(20s), 0) << primary.errors();
    EXPECT_EQ(standby.wait(20s), 0) << standby.errors();
    EXPECT_EQ(primary.errors().find("within 3 s"), std::string::npos) << primary.errors();
    servers_.clear();
  }
}

TEST_F(ServerTakeover, MembersThatJoinTakeThePartThatIsLeft) {
  const auto start_member = [&](const std::string& name) -> ChildProcess& {
    return join(name, false, {"--join", "collided"});
  };
  ChildProcess& first = start_member("north");
  Client client = connect();
  Publisher publisher = publish(client, "nobody");
  start_member("south");
  EXPECT_EQ(member("north").role, FleetRole::primary);
  EXPECT_EQ(member("south").role, FleetRole::standby);
  ASSERT_TRUE(becomes_ready("south", publisher)) << servers_.back()->errors();
  first.signal(SIGKILL);
  ASSERT_EQ(first.wait(5s), 128 + SIGKILL);
  ChildProcess& again = start_member("north");
  EXPECT_TRUE(becomes_primary("south")) << servers_[1]->errors();
  ASSERT_TRUE(becomes_ready("north", publisher)) << again.errors();
  EXPECT_EQ(member("north").role, FleetRole::standby);
}

TEST_F(ServerTakeover, OfTwoThatJoinAtOnceOneGivesWay) {
  std::vector<std::unique_ptr<ChildProcess>> members;
  for (const std::string name : {"north", "south"}) {
    members.push_back(std::make_unique<ChildProcess>(
        std::vector<std::string>{COLLIDED_SERVER, "--domain", std::to_string(domain_), "--join", "collided", "--member",
                                 name, "--state-dir", folder_.path() + "/" + name},
        folder_.path(), name));
  }
  for (const auto& one : members) ASSERT_TRUE(one->says("ready:", 20s)) << one->errors();
  EXPECT_TRUE(test::eventually(
      [&] {
        const Result<Fleet> all = fleet({.domain = domain_});
        if (!all) return false;
        const auto count = [&](FleetRole role) { return std::ranges::count(all->members, role, &FleetMember::role); };
        return count(FleetRole::primary) == 1;
      },
      20s));
  const bool has_one_left = (members[0]->wait(10s) == 3) != (members[1]->wait(1ms) == 3);
  const bool was_one_standby = member("north").role != member("south").role;
  EXPECT_TRUE(has_one_left || was_one_standby) << members[0]->errors() << members[1]->errors();
}

TEST_F(ServerTakeover, OneThatDoesNotHoldTheSameWorldDoesNotTakeThePlace) {
  ChildProcess& primary = join("north", false);
  join("south", true, {COLLIDED_SOURCE_DIR "/deploy/examples/cell.csv"});
  ASSERT_TRUE(test::eventually([&] { return !member("south").alarm.empty(); }, 40s));
  primary.signal(SIGKILL);
  EXPECT_TRUE(test::eventually(
      [&] {
        return member("south").alarm.find("the primary is silent, and this server does not hold all that it had") !=
               std::string::npos;
      },
      20s))
      << member("south").alarm;
  EXPECT_EQ(member("south").role, FleetRole::standby);
}

TEST_F(ServerTakeover, OfTwoThatStandByOneTakesThePlaceAndTheOtherOneItsPlaceInTurn) {
  ChildProcess& primary = join("north", false);
  Client client = connect();
  Publisher publisher = publish(client, "balls");
  add_ball(publisher, "post", at(0, 0, 9));
  const auto resting = add_ball(publisher, "resting", at(3, 0, 9));
  const auto mover = add_ball(publisher, "mover", at(1, 0, 9));
  add_ball(publisher, "other post", at(3, 0, 9.15));
  std::map<std::string, ChildProcess*> standbys;
  for (const std::string name : {"south", "west"}) standbys[name] = &join(name, true);
  Watch watching = watch(client);
  ASSERT_EQ(next(watching).kind, EventKind::open);
  ASSERT_TRUE(
      client.command("add", R"({"name": "crate", "pose": [9, 0, 9, 1, 0, 0, 0]})", {SphereShape{.radius_m = 0.3}}, 5s));
  for (const auto& [name, standby] : standbys) ASSERT_TRUE(becomes_ready(name, publisher)) << standby->errors();
  const std::uint64_t first = member("north").epoch;
  std::set<std::uint64_t> epochs{first, member("south").epoch, member("west").epoch};
  EXPECT_EQ(epochs.size(), 3U) << "two that stand by can be told apart";
  const auto moves_on = [&] {
    for (int i = 0; i < 3; ++i) {
      move(publisher, mover, at(0.15, 0, 9));
      move(publisher, mover, at(1, 0, 9));
    }
    std::vector<std::string> events;
    for (int i = 0; i < 6; ++i) events.push_back(told(watching));
    EXPECT_EQ(events, (std::vector<std::string>{"began", "ended", "began", "ended", "began", "ended"}));
  };
  primary.signal(SIGKILL);
  moves_on();
  ASSERT_TRUE(test::eventually(
      [&] { return member("south").role == FleetRole::primary || member("west").role == FleetRole::primary; }, 30s));
  const bool is_souths = member("south").role == FleetRole::primary;
  const std::string heir = is_souths ? "south" : "west";
  const std::string last = is_souths ? "west" : "south";
  const std::uint64_t second = member(heir).epoch;
  EXPECT_GT(second, first);
  ASSERT_TRUE(client.command("move", R"({"name": "crate", "pose": [9, 1, 9, 1, 0, 0, 0]})", {}, 5s));
  ASSERT_TRUE(becomes_ready(last, publisher)) << standbys[last]->errors();
  EXPECT_EQ(member(last).alarm, "");
  EXPECT_GT(member(last).epoch, second);
  standbys[heir]->signal(SIGKILL);
  moves_on();
  EXPECT_TRUE(becomes_primary(last)) << standbys[last]->errors();
  move(publisher, resting, at(4, 0, 9));
  const Event ended = next(watching);
  EXPECT_TRUE(ended.kind == EventKind::ended && (ended.a == "resting" || ended.b == "resting"));
  EXPECT_FALSE(ended.resync);
  EXPECT_GT(ended.epoch, second);
  EXPECT_EQ(ended.epoch, member(last).epoch);
  EXPECT_FALSE(watching.next(300ms)) << "nothing is told twice";
  // What the one in between was told is there, too.
  const std::vector<RayQuestion> down{{.origin = {9, 1, 20}, .direction = {0, 0, -1}, .length_m = 100}};
  const Result<Answers> hit = client.ask(down);
  ASSERT_TRUE(hit) << hit.error().message;
  EXPECT_EQ(hit->answers.at(0).hits.at(0).object, "crate");
  EXPECT_EQ(hit->epoch, ended.epoch);
}

// The one that was stopped hears of both only when it goes on, and is heard once more by the one that has turned away from it.
TEST_F(ServerTakeover, OneThatWasStoppedDoesNotTurnAStandbyAwayFromItsHeir) {
  ChildProcess& primary = join("north", false);
  Client client = connect();
  Publisher publisher = publish(client, "nobody");
  std::map<std::string, ChildProcess*> standbys;
  for (const std::string name : {"south", "west"}) standbys[name] = &join(name, true);
  for (const auto& [name, standby] : standbys) ASSERT_TRUE(becomes_ready(name, publisher)) << standby->errors();
  primary.signal(SIGSTOP);
  ASSERT_TRUE(test::eventually(
      [&] { return member("south").role == FleetRole::primary || member("west").role == FleetRole::primary; }, 30s));
  const std::string last = member("south").role == FleetRole::primary ? "west" : "south";
  ASSERT_TRUE(becomes_ready(last, publisher)) << standbys[last]->errors();
  primary.signal(SIGCONT);
  EXPECT_EQ(primary.wait(20s), 3) << primary.errors();
  ASSERT_TRUE(becomes_ready(last, publisher)) << standbys[last]->errors();
  EXPECT_EQ(member(last).alarm, "");
}

}  // namespace
}  // namespace collided
