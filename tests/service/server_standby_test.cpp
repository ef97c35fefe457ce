// A second server holds the same world as the first, and says nothing.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "collided/commands.hpp"
#include "collided/fleet.hpp"
#include "idl/dds.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using testing_support::ChildProcess;
using testing_support::ScratchFolder;

class ServerStandby : public testing_support::ServerTest {
 protected:
  ChildProcess& start_standby(const std::vector<std::string>& options = {}) {
    std::vector<std::string> words{COLLIDED_SERVER, "--domain", std::to_string(domain_), "--standby-of", "collided",
                                   "--member", "standby", "--state-dir", elsewhere_.path(),
                                   // A crowded machine would have it take over where a test does not expect it.
                                   "--take-over-after", "never"};
    words.insert(words.end(), options.begin(), options.end());
    standbys_.push_back(std::make_unique<ChildProcess>(words, elsewhere_.path(), "standby"));
    EXPECT_TRUE(standbys_.back()->says("ready: standing by", 20s)) << standbys_.back()->errors();
    return *standbys_.back();
  }
  std::map<std::string, FleetMember> members() {
    std::map<std::string, FleetMember> found;
    const Result<Fleet> all = fleet({.domain = domain_});
    if (!all) return found;
    for (const FleetMember& member : all->members) found[member.name] = member;
    return found;
  }
  /// Whether the two come to hold the same world, and the standby says so.
  ///
  /// meanwhile  what is called again and again: a publisher speaks only when its user does
  bool come_to_agree(const std::function<void()>& meanwhile = [] {}) {
    return test::eventually(
        [&] {
          meanwhile();
          std::map<std::string, FleetMember> found = members();
          const FleetMember& primary = found["primary"];
          const FleetMember& standby = found["standby"];
          last_ = "primary " + primary.state + " standby " + standby.state + " alarm " + standby.alarm;
          return standby.state == "ready" && standby.hash_time != 0s && standby.hash_time == primary.hash_time &&
                 standby.world_hash == primary.world_hash && standby.alarm.empty();
        },
        40s);
  }
  static void done(const Result<std::string>& answer) { EXPECT_TRUE(answer) << answer.error().message; }
  static void command(Client& client, const std::string& name, const std::string& arguments, const Shape& shape = {}) {
    done(client.command(name, arguments, shape, 5s));
  }

  ScratchFolder elsewhere_;
  std::vector<std::unique_ptr<ChildProcess>> standbys_;
  std::string last_;  // what was seen last
};

// Everything that commands do, before it starts and after, beside a publisher that moves what others rest beside.
TEST_F(ServerStandby, ItHoldsWhatPublishersSendAndWhatCommandsDoBeforeAndAfterItStarts) {
  start({"--member", "primary"});
  Client client = connect();
  Publisher publisher = publish(client, "carts");
  const auto moved_early = add_ball(publisher, "moved early", at(0, 0, 5));
  const auto mover = add_ball(publisher, "mover", at(0, 5, 5));
  move(publisher, moved_early, at(1, 0, 5));
  // What a publisher sends takes another way than commands.
  ASSERT_TRUE(test::eventually([&] { return !!client.command("get", R"({"name": "mover"})", {}, 5s); }));
  const Shape ball{SphereShape{.radius_m = 0.3}};
  command(client, "add", R"({"name": "crate", "pose": [3, 0, 9, 1, 0, 0, 0]})", ball);
  command(client, "add", R"({"name": "box", "pose": [3, 3, 9, 1, 0, 0, 0]})", ball);
  command(client, "add", R"({"name": "gone", "pose": [6, 3, 9, 1, 0, 0, 0]})", ball);
  command(client, "move", R"({"name": "crate", "pose": [4, 0, 9, 1, 0, 0, 0]})");
  command(client, "remove", R"({"name": "gone"})");
  command(client, "attach", R"({"child": "box", "parent": "mover"})");
  const std::string wall = folder_.write("wall.obj", "v 0 0 20\nv 1 0 20\nv 0 1 20\nf 1 2 3\n");
  command(client, "load", R"({"path": ")" + wall + R"("})");
  start_standby();
  for (int i = 1; i <= 20; ++i) move(publisher, mover, at(0.1 * i, 5, 5));
  const auto speak = [&] { EXPECT_TRUE(publisher.keep_alive()); };
  EXPECT_TRUE(come_to_agree(speak)) << last_ << standbys_[0]->errors();
  command(client, "add", R"({"name": "late", "pose": [8, 0, 9, 1, 0, 0, 0]})", ball);
  command(client, "move", R"({"name": "crate", "pose": [5, 0, 9, 1, 0, 0, 0]})");
  command(client, "detach", R"({"child": "box"})");
  command(client, "clear", R"({"scene": "wall"})");
  move(publisher, mover, at(0, 7, 5));
  EXPECT_TRUE(come_to_agree(speak)) << last_ << standbys_[0]->errors();
  EXPECT_EQ(members()["standby"].scene_fingerprint, members()["primary"].scene_fingerprint);
  const Result<Plan> plan = client.plan();
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_TRUE(std::ranges::any_of(plan->wings, [](const Wing& wing) { return wing.name == "fleet" && wing.in_use; }));
}

TEST_F(ServerStandby, ItAnswersNothingAndTellsNoEvents) {
  start({"--member", "primary"});
  start_standby();
  const dds::Participant listener({.domain = domain_, .role = dds::Role::server, .process_domain = domain_ + 100'000});
  const dds::Topic<wire::Status> statuses(listener, "collided");
  const dds::Topic<wire::EventFrame> events(listener, "collided");
  dds::Reader<wire::Status> status_reader(statuses);
  dds::Reader<wire::EventFrame> event_reader(events);
  Client client = connect();
  const std::uint64_t epoch = client.status()->epoch;
  Publisher publisher = publish(client, "balls");
  Watch watching = watch(client);
  const auto a = add_ball(publisher, "a", at(0, 0, 9));
  add_ball(publisher, "b", at(1, 0, 9));
  EXPECT_TRUE(test::eventually([&] { return event_reader.matched_writers() == 2; }));
  for (int round = 0; round < 20; ++round) {
    move(publisher, a, at(0.95, 0, 9));
    move(publisher, a, at(0, 0, 9));
  }
  std::map<std::string, int> told;
  for (int i = 0; i < 40; ++i) ++told[next(watching).kind == EventKind::began ? "began" : "ended"];
  EXPECT_EQ(told, (std::map<std::string, int>{{"began", 20}, {"ended", 20}}));
  EXPECT_FALSE(watching.next(500ms));
  EXPECT_EQ(watching.resyncs(), 0U);
  std::set<std::uint64_t> speakers;
  dds::Sample<wire::Status> status;
  while (status_reader.take(status))
    if (status.info().valid_data) speakers.insert(status->epoch);
  dds::Sample<wire::EventFrame> frame;
  while (event_reader.take(frame))
    if (frame.info().valid_data) speakers.insert(frame->epoch);
  EXPECT_EQ(speakers, std::set<std::uint64_t>{epoch});
}

// It holds one object more than the primary.
TEST_F(ServerStandby, AWorldThatDiffersIsAnAlarmThatNamesTheObject) {
  ChildProcess& primary = start({"--member", "primary"});
  const std::string scene = COLLIDED_SOURCE_DIR "/deploy/examples/cell.csv";
  ChildProcess& standby = start_standby({scene});
  EXPECT_TRUE(
      test::eventually([&] { return members()["standby"].alarm.find("differs first") != std::string::npos; }, 40s))
      << members()["standby"].alarm << standby.errors();
  EXPECT_NE(standby.errors().find("the world is not the primary's: object '"), std::string::npos) << standby.errors();
  EXPECT_EQ(members()["standby"].state, "recovering");
  EXPECT_EQ(primary.errors().find("two primaries"), std::string::npos);
}

// At each instant that is compared some command may be done by one of the two alone.
TEST_F(ServerStandby, ItStaysReadyWhileCommandsGoOn) {
  start({"--member", "primary"});
  ChildProcess& standby = start_standby();
  EXPECT_TRUE(come_to_agree()) << last_;
  std::atomic<bool> is_over{false};
  std::vector<std::thread> commanders;
  for (int who = 0; who < 4; ++who) {
    commanders.emplace_back([&, who] {
      Client client = connect();
      for (int i = 0; !is_over.load(); ++i) {
        const std::string name = std::to_string(who) + '_' + std::to_string(i);
        EXPECT_TRUE(client.add({.name = name, .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(who, i % 100, 50)}));
        EXPECT_TRUE(client.remove(name));
      }
    });
  }
  int looks = 0;
  const auto until = std::chrono::steady_clock::now() + 6s;
  for (; std::chrono::steady_clock::now() < until; ++looks) {
    const FleetMember seen = members()["standby"];
    EXPECT_EQ(seen.state, "ready") << seen.alarm;
  }
  is_over.store(true);
  for (std::thread& commander : commanders) commander.join();
  EXPECT_GT(looks, 0);
  EXPECT_EQ(standby.errors().find("differs first"), std::string::npos) << standby.errors();
  EXPECT_TRUE(come_to_agree()) << last_;
}

TEST_F(ServerStandby, WhatItCannotDoIsAnAlarm) {
  start({"--member", "primary"});
  start_standby({"--max-objects", "40"});
  Client client = connect();
  EXPECT_TRUE(come_to_agree()) << last_;
  for (int i = 0; i < 12; ++i) {
    command(client, "add", R"({"name": "n)" + std::to_string(i) + R"(", "pose": [0, 0, 30, 1, 0, 0, 0]})",
            {SphereShape{.radius_m = 0.1}});
  }
  EXPECT_TRUE(test::eventually(
      [&] { return members()["standby"].alarm.starts_with("what the primary did cannot be done here: "); }, 20s))
      << members()["standby"].alarm;
}

TEST_F(ServerStandby, APrimaryThatKeepsNothingCannotBeFollowedAndThatIsSaid) {
  ChildProcess primary({COLLIDED_SERVER, "--domain", std::to_string(domain_), "--member", "primary", "--state-dir",
                        folder_.write("no folder", "")},
                       folder_.path(), "primary");
  ASSERT_TRUE(primary.says("ready:", 20s)) << primary.errors();
  start_standby();
  EXPECT_TRUE(test::eventually(
      [&] { return members()["standby"].alarm.starts_with("'primary' does not send what it keeps"); }, 40s))
      << members()["standby"].alarm << standbys_[0]->errors();
  EXPECT_EQ(members()["standby"].state, "recovering");
}

TEST_F(ServerStandby, TwoStandbysBothFollow) {
  start({"--member", "primary"});
  start_standby();
  const ScratchFolder third;
  ChildProcess other({COLLIDED_SERVER, "--domain", std::to_string(domain_), "--standby-of", "collided", "--member",
                      "other", "--state-dir", third.path(), "--take-over-after", "never"},
                     third.path(), "other");
  ASSERT_TRUE(other.says("ready: standing by", 20s)) << other.errors();
  EXPECT_TRUE(come_to_agree()) << last_;
  EXPECT_TRUE(test::eventually([&] { return members()["other"].state == "ready"; }, 40s)) << other.errors();
  EXPECT_EQ(members().size(), 3U);
}

// What a new primary has need not be what it has.
TEST_F(ServerStandby, APrimaryThatDiedIsMissedAndOneThatWasStartedAgainIsNotFollowed) {
  ChildProcess& primary = start({"--member", "primary"});
  start_standby();
  EXPECT_TRUE(come_to_agree()) << last_;
  primary.signal(SIGKILL);
  primary.wait(5s);
  const Result<Fleet> orphaned = fleet({.domain = domain_});
  ASSERT_TRUE(orphaned) << orphaned.error().message;
  ASSERT_EQ(orphaned->members.size(), 1U);
  ASSERT_EQ(orphaned->findings.size(), 1U);
  EXPECT_EQ(orphaned->findings[0].text, "no primary: nobody answers");
  start({"--member", "primary"}, "again");
  EXPECT_TRUE(test::eventually(
      [&] {
        return members()["standby"].alarm.find("another one was followed; start this server again") !=
               std::string::npos;
      },
      20s))
      << members()["standby"].alarm;
}

TEST_F(ServerStandby, ItNeedsAStateFolderOfItsOwn) {
  start({"--member", "primary"});
  const Ended refused =
      run({"--domain", std::to_string(domain_), "--standby-of", "collided", "--state-dir", folder_.path()});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.errors.find("give a standby a --state-dir of its own"), std::string::npos) << refused.errors;
}

}  // namespace
}  // namespace collided
