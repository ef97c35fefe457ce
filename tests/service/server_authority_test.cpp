// With an authority (a real etcd) at most one server of a namespace publishes and answers.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collided/commands.hpp"
#include "collided/fleet.hpp"
#include "idl/clocks.hpp"
#include "idl/dds.hpp"
#include "tests/service/etcd_process.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using testing_support::ChildProcess;
using testing_support::EtcdCluster;

class ServerAuthority : public testing_support::ServerTest {
 protected:
  void SetUp() override {
    if (!testing_support::has_etcd()) GTEST_SKIP() << "etcd-server is not installed";
  }
  void start_etcd(int members = 1) {
    etcd_ = std::make_unique<EtcdCluster>(members, folder_.path());
    ASSERT_TRUE(etcd_->is_ready(20s)) << etcd_->member(0).output();
  }
  std::vector<std::string> words(const std::string& name, std::vector<std::string> more) const {
    std::vector<std::string> all{COLLIDED_SERVER,
                                 "--domain",
                                 std::to_string(domain_),
                                 "--member",
                                 name,
                                 "--state-dir",
                                 folder_.path() + "/" + name,
                                 "--authority",
                                 etcd_->address(),
                                 "--take-over-after",
                                 "1s"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Starts a server and does not wait for it.
  ChildProcess& begin(const std::string& name, const std::vector<std::string>& more = {}) {
    servers_.push_back(std::make_unique<ChildProcess>(words(name, more), folder_.path(), name));
    return *servers_.back();
  }
  ChildProcess& join(const std::string& name, const std::vector<std::string>& more = {}) {
    ChildProcess& server = begin(name, more);
    EXPECT_TRUE(server.says("ready:", 20s)) << server.errors();
    return server;
  }
  std::optional<FleetMember> member(const std::string& name) {
    const Result<Fleet> all = fleet({.domain = domain_});
    if (!all) return std::nullopt;
    const auto found = std::ranges::find(all->members, name, &FleetMember::name);
    return found == all->members.end() ? std::nullopt : std::optional(*found);
  }
  bool becomes_ready(const std::string& name, Publisher& publisher) {
    return test::eventually(
        [&] {
          static_cast<void>(publisher.keep_alive());
          const std::optional<FleetMember> one = member(name);
          return one && one->state == "ready" && one->hash_time != 0s;
        },
        40s);
  }
  static bool logs(const ChildProcess& server, const std::string& text, std::chrono::milliseconds wait = 20s) {
    return test::eventually([&] { return server.errors().find(text) != std::string::npos; }, wait);
  }

  std::unique_ptr<EtcdCluster> etcd_;
};

/// Hears every status of the namespace, as clients that know of no epoch would.
class StatusListener {
 public:
  explicit StatusListener(int domain)
      : participant_({.domain = domain, .role = dds::Role::server, .process_domain = domain + 100'000}),
        topic_(participant_, "collided"),
        reader_(topic_) {}
  /// How many were written after that, in nanoseconds since 1970, by servers with an epoch below that one.
  int written_below(std::uint64_t epoch, std::int64_t after_ns) {
    int found = 0;
    while (reader_.take(status_)) {
      const bool is_late = status_.info().valid_data && status_.info().source_timestamp > after_ns;
      found += is_late && status_->epoch < epoch ? 1 : 0;
    }
    return found;
  }

 private:
  dds::Participant participant_;
  dds::Topic<wire::Status> topic_;
  dds::Reader<wire::Status> reader_;
  dds::Sample<wire::Status> status_;
};

// Neither hears the other before it has begun: both listen for as long.
TEST_F(ServerAuthority, OfTwoPrimariesStartedAtOnceOneServes) {
  start_etcd();
  begin("north", {"--authority-lease", "2s"});
  begin("south", {"--authority-lease", "2s"});
  const auto is_serving = [](ChildProcess& one) { return one.says("ready:", 10ms); };
  ASSERT_TRUE(test::eventually([&] { return is_serving(*servers_[0]) || is_serving(*servers_[1]); }, 20s));
  ChildProcess& other = is_serving(*servers_[0]) ? *servers_[1] : *servers_[0];
  const int code = other.wait(20s);
  EXPECT_TRUE(code == 3 || code == 2) << code << other.errors();
  EXPECT_FALSE(is_serving(other));
  EXPECT_TRUE(connect().ask(RayQuestion{.origin = {0, 0, 50}, .direction = {0, 0, -1}, .length_m = 100}));
}

// Refused before anything is loaded or written.
TEST_F(ServerAuthority, WithoutEtcdAtTheStartItRefusesWithTheReason) {
  const int port = testing_support::free_ports(1)[0];
  const std::string address = "127.0.0.1:" + std::to_string(port);
  const Ended refused = run({"--domain", std::to_string(domain_), "--state-dir", folder_.path(), "--authority",
                             "etcd://" + address, "--authority-lease", "2s"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.errors.find("error: etcd: " + address +
                                ": Connection refused\n       no epoch within 4 s; nothing was started"),
            std::string::npos)
      << refused.errors;
}

TEST_F(ServerAuthority, StrictWaitsForTheLeaseOfAPrimaryThatWasKilledAndEventsGoOn) {
  start_etcd();
  ChildProcess& north = join("north");
  Client client = connect();
  Publisher publisher = publish(client, "balls");
  add_ball(publisher, "post", at(0, 0, 9));
  const auto mover = add_ball(publisher, "mover", at(1, 0, 9));
  ChildProcess& south = join("south", {"--standby-of", "collided"});
  Watch watching = watch(client);
  ASSERT_TRUE(becomes_ready("south", publisher)) << south.errors();
  north.signal(SIGKILL);
  const auto killed_at = std::chrono::steady_clock::now();
  move(publisher, mover, at(0.15, 0, 9));
  EXPECT_EQ(next(watching, 20s).kind, EventKind::began);
  const auto gap = std::chrono::steady_clock::now() - killed_at;
  // etcd ends no lease early; it was renewed a quarter of a second before, at the earliest.
  EXPECT_GT(gap, 2s) << "a lease of 3 s that had been confirmed";
  EXPECT_LT(gap, 15s);
  EXPECT_TRUE(logs(south, "waiting for the lease of 'north' to end")) << south.errors();
  move(publisher, mover, at(1, 0, 9));
  EXPECT_EQ(next(watching).kind, EventKind::ended);
  EXPECT_FALSE(watching.next(300ms)) << "nothing is told twice";
}

TEST_F(ServerAuthority, FastTakesThePlaceAtOnceAndTellsOfTheWindow) {
  start_etcd();
  ChildProcess& north = join("north", {"--authority-mode", "fast", "--authority-lease", "20s"});
  Client client = connect();
  Publisher publisher = publish(client, "nobody");
  ChildProcess& south =
      join("south", {"--standby-of", "collided", "--authority-mode", "fast", "--authority-lease", "20s"});
  ASSERT_TRUE(becomes_ready("south", publisher)) << south.errors();
  north.signal(SIGSTOP);
  const auto stopped_at = std::chrono::steady_clock::now();
  EXPECT_TRUE(logs(south, "this server has taken its place")) << south.errors();
  EXPECT_LT(std::chrono::steady_clock::now() - stopped_at, 13s) << "the lease is 20 s";
  EXPECT_TRUE(logs(south, "the one before may publish and answer until it next asks etcd, for 6.7 s at most"));
  north.signal(SIGCONT);
  EXPECT_EQ(north.wait(20s), 3) << north.errors();
}

TEST_F(ServerAuthority, APrimaryThatWasStoppedPastItsLeaseTellsNothingAndGivesWay) {
  start_etcd();
  ChildProcess& north = join("north");
  Client client = connect();
  Publisher publisher = publish(client, "nobody");
  ChildProcess& south = join("south", {"--standby-of", "collided"});
  StatusListener listener(domain_);
  ASSERT_TRUE(becomes_ready("south", publisher)) << south.errors();
  north.signal(SIGSTOP);
  ASSERT_TRUE(logs(south, "this server has taken its place")) << south.errors();
  const std::optional<FleetMember> heir = member("south");
  ASSERT_TRUE(heir);
  const std::int64_t continued_ns = wire_contract::since_1970_ns();
  north.signal(SIGCONT);
  EXPECT_EQ(north.wait(20s), 3) << north.errors();
  EXPECT_EQ(listener.written_below(heir->epoch, continued_ns), 0);
  EXPECT_NE(north.errors().find("this server's place"), std::string::npos) << north.errors();
}

TEST_F(ServerAuthority, WithEtcdStoppedThePrimaryFallsSilentAndGoesOnWithAllThatHappened) {
  start_etcd();
  ChildProcess& north = join("north");
  Client client = connect();
  Publisher publisher = publish(client, "balls");
  add_ball(publisher, "post", at(0, 0, 9));
  const auto mover = add_ball(publisher, "mover", at(1, 0, 9));
  Watch watching = watch(client);
  etcd_->member(0).signal(SIGSTOP);
  ASSERT_TRUE(logs(north, "it publishes and answers nothing until it is")) << north.errors();
  const std::optional<FleetMember> silent = member("north");
  ASSERT_TRUE(silent);
  EXPECT_EQ(silent->role, FleetRole::primary);
  EXPECT_TRUE(silent->alarm.starts_with("silent, since its place as the primary is not confirmed: etcd: 127.0.0.1:"))
      << silent->alarm;
  move(publisher, mover, at(0.15, 0, 9));
  move(publisher, mover, at(1, 0, 9));
  move(publisher, mover, at(0.15, 0, 9));
  EXPECT_FALSE(watching.next(500ms));
  EXPECT_FALSE(
      client.ask(RayQuestion{.origin = {0, 0, 50}, .direction = {0, 0, -1}, .length_m = 100}, {.timeout = 500ms}));
  etcd_->member(0).signal(SIGCONT);
  std::string told;
  for (int i = 0; i < 3; ++i) told += next(watching, 20s).kind == EventKind::began ? "began " : "ended ";
  EXPECT_EQ(told, "began ended began ");
  EXPECT_FALSE(watching.next(300ms)) << "nothing is told twice";
  EXPECT_TRUE(logs(north, "is confirmed again: it goes on")) << north.errors();
  EXPECT_TRUE(
      client.ask(RayQuestion{.origin = {0, 0, 50}, .direction = {0, 0, -1}, .length_m = 100}, {.timeout = 10s}));
}

TEST_F(ServerAuthority, OverTheDeathOfEtcdsLeaderNoQuestionIsRefused) {
  start_etcd(3);
  ASSERT_TRUE(test::eventually([&] { return etcd_->leader() >= 0; }, 20s));
  // A third of it is longer than three members need for another leader, also on a crowded machine.
  ChildProcess& north = join("north", {"--authority-lease", "15s"});
  Client client = connect();
  etcd_->member(etcd_->leader()).signal(SIGKILL);
  const auto until = std::chrono::steady_clock::now() + 3s;
  int asked = 0;
  for (; std::chrono::steady_clock::now() < until; ++asked) {
    const Result<Answer> answer =
        client.ask(RayQuestion{.origin = {0, 0, 50}, .direction = {0, 0, -1}, .length_m = 100}, {.timeout = 5s});
    ASSERT_TRUE(answer) << answer.error().message << north.errors();
  }
  EXPECT_GT(asked, 50);
  EXPECT_EQ(north.errors().find("is not confirmed"), std::string::npos) << north.errors();
}

TEST_F(ServerAuthority, WhatHandsOverGivesUpThePlaceFirst) {
  start_etcd();
  ChildProcess& north = join("north");
  Client client = connect();
  Publisher publisher = publish(client, "nobody");
  ChildProcess& south = join("south", {"--standby-of", "collided"});
  ASSERT_TRUE(becomes_ready("south", publisher)) << south.errors();
  const auto asked_at = std::chrono::steady_clock::now();
  north.signal(SIGTERM);
  EXPECT_EQ(north.wait(20s), 0) << north.errors();
  EXPECT_LT(std::chrono::steady_clock::now() - asked_at, 10s);
  EXPECT_NE(north.errors().find("'south' has this server's place"), std::string::npos) << north.errors();
  EXPECT_NE(south.errors().find("the primary hands over: this server has taken its place"), std::string::npos)
      << south.errors();
}

}  // namespace
}  // namespace collided
