// A replica answers beside the primary, what the primary would answer, and nobody misses it when it is gone.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "collided/commands.hpp"
#include "collided/fleet.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using testing_support::ChildProcess;
using testing_support::ScratchFolder;

constexpr int kBalls = 24;

/// Bit for bit, but for what is the server's own: numbers of objects, and what it took to find out.
bool is_same(const Hit& a, const Hit& b) {
  return a.object == b.object && a.triangle == b.triangle && a.distance_m == b.distance_m && a.error_m == b.error_m &&
         a.exit_m == b.exit_m && a.point == b.point && a.point_error_m == b.point_error_m && a.normal == b.normal &&
         a.weights == b.weights && a.inside == b.inside && a.by_winding == b.by_winding && a.stale == b.stale;
}
bool is_same(const Answer& a, const Answer& b) {
  return a.verdict == b.verdict && a.reason == b.reason &&
         std::ranges::equal(a.hits, b.hits, [](const Hit& one, const Hit& other) { return is_same(one, other); });
}

class ServerReplica : public testing_support::ServerTest {
 protected:
  ChildProcess& start_replica(const std::string& name) {
    replicas_.push_back(std::make_unique<ChildProcess>(
        std::vector<std::string>{COLLIDED_SERVER, "--domain", std::to_string(domain_), "--replica-of", "collided",
                                 "--member", name, "--state-dir", elsewhere_.path() + "/" + name},
        elsewhere_.path(), name + std::to_string(replicas_.size())));
    EXPECT_TRUE(replicas_.back()->says("ready: replica, namespace 'collided/replica_" + name + "'", 20s))
        << replicas_.back()->errors();
    return *replicas_.back();
  }
  Client connect_alone(const std::string& name_space) {
    Result<Client> client =
        Client::connect({.domain = domain_, .name_space = name_space, .wait = 10s, .replicas = false});
    EXPECT_TRUE(client) << client.error().message << " " << client.error().hint;
    return std::move(*client);
  }
  FleetMember member(const std::string& name) {
    const Result<Fleet> all = fleet({.domain = domain_});
    if (!all) return {};
    const auto found = std::ranges::find(all->members, name, &FleetMember::name);
    return found == all->members.end() ? FleetMember{} : *found;
  }
  bool becomes_ready(const std::string& name) {
    return test::eventually([&] { return member(name).state == "ready"; }, 40s);
  }

  /// Balls that go to and fro, each its own way, until this is destroyed.
  class Movement {
   public:
    explicit Movement(Publisher& publisher) : publisher_(publisher) {
      for (int i = 0; i < kBalls; ++i) balls_.push_back(add_ball(publisher, "ball_" + std::to_string(i), where(i, 0)));
      thread_ = std::thread([this] {
        for (int tick = 1; !is_over_.load(); ++tick) {
          for (int i = 0; i < kBalls; ++i)
            static_cast<void>(publisher_.move(balls_[static_cast<std::size_t>(i)], where(i, tick)));
          static_cast<void>(publisher_.flush());
          std::this_thread::sleep_for(10ms);
        }
      });
    }
    ~Movement() {
      is_over_.store(true);
      thread_.join();
    }

   private:
    static Pose where(int ball, int tick) {
      return at(ball % 6 + 0.4 * std::sin(0.03 * tick * (1 + ball % 5)), ball / 6 + 0.4 * std::cos(0.02 * tick), 20);
    }
    Publisher& publisher_;
    std::vector<Publisher::Object> balls_;
    std::atomic<bool> is_over_{false};
    std::thread thread_;
  };

  ScratchFolder elsewhere_;
  std::vector<std::unique_ptr<ChildProcess>> replicas_;
};

/// Random questions about where the balls are.
class RandomAsker {
 public:
  template <class Q, class Make>
  std::vector<Q> of(std::size_t count, const Make& make) {
    std::vector<Q> questions;
    for (std::size_t i = 0; i < count; ++i) questions.push_back(make());
    return questions;
  }
  Vec3 point() { return {number(-1, 7), number(-1, 5), number(19, 21)}; }
  RayQuestion ray() { return {.origin = point(), .direction = Vec3(number(-1, 1), number(-1, 1), number(-0.2, 0.2))}; }
  SphereQuestion sphere() { return {.center = point(), .radius_m = number(0, 1)}; }
  BoxQuestion box() { return {.center = point(), .half_m = {number(0, 1), number(0, 1), number(0, 1)}}; }
  NearQuestion near() { return {.point = point()}; }
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

 private:
  std::mt19937_64 random_ = oracle::seeded(28);
};

// While the balls move: about an instant, both give the same answers.
TEST_F(ServerReplica, ItsAnswersAreThePrimarysBitForBit) {
  start({"--member", "primary"});
  Client primary = connect_alone("collided");
  start_replica("east");
  Publisher publisher = publish(primary, "balls");
  const Movement movement(publisher);
  ASSERT_TRUE(becomes_ready("east")) << member("east").alarm << replicas_[0]->errors();
  EXPECT_EQ(member("east").role, FleetRole::replica);
  Client replica = connect_alone("collided/replica_east");
  RandomAsker random;
  std::size_t compared = 0, hits = 0;
  const auto compare = [&](const auto& questions, HitMode mode) {
    const AskOptions options{.mode = mode,
                             .max_hits = 8,
                             .timeout = 10s,
                             .as_of = {Instant::Kind::at, primary.status()->world_time - 200ms}};
    const Result<Answers> a = primary.ask(questions, options);
    const Result<Answers> b = replica.ask(questions, options);
    ASSERT_TRUE(a) << a.error().message;
    ASSERT_TRUE(b) << b.error().message;
    ASSERT_NE(a->server, b->server);
    ASSERT_EQ(a->world_time, b->world_time);
    for (std::size_t i = 0; i < questions.size(); ++i) {
      ASSERT_TRUE(is_same(a->answers[i], b->answers[i])) << "question " << i << " of the batch after " << compared;
      hits += a->answers[i].hits.size();
    }
    compared += questions.size();
  };
  while (compared < 10'000 && !HasFatalFailure()) {
    compare(random.of<RayQuestion>(500, [&] { return random.ray(); }), HitMode::all);
    compare(random.of<SphereQuestion>(300, [&] { return random.sphere(); }), HitMode::all);
    compare(random.of<BoxQuestion>(100, [&] { return random.box(); }), HitMode::all);
    compare(random.of<NearQuestion>(100, [&] { return random.near(); }), HitMode::signed_near);
  }
  EXPECT_GT(hits, compared / 4);
  const Result<Moved> moved = replica.move("ball_0", at(0, 0, 0));
  ASSERT_FALSE(moved);
  EXPECT_NE(moved.error().message.find("this is a replica"), std::string::npos) << moved.error().message;
}

// Its own words are in every answer, whoever gives it, and replicas come and go.
TEST_F(ServerReplica, QuestionsAreSpreadAndNoneFailsWhereReplicasDieOrStandStill) {
  start({"--member", "primary"});
  start_replica("east");
  start_replica("west");
  Client client = connect();
  Publisher publisher = publish(client, "balls");
  const Movement movement(publisher);
  ASSERT_TRUE(becomes_ready("east") && becomes_ready("west")) << replicas_[0]->errors() << replicas_[1]->errors();
  const auto look = [&](double x, const AskOptions& options = {}) {
    return client.ask(std::vector{RayQuestion{.origin = {x, -50, 50}, .direction = {0, 1, 0}, .length_m = 100}},
                      options);
  };
  const auto ask = [&](int count) {
    std::map<std::uint64_t, int> answered;
    for (int i = 0; i < count; ++i) {
      const Result<Answers> answers = look(0);
      EXPECT_TRUE(answers) << answers.error().message;
      if (answers) ++answered[answers->server];
    }
    return answered;
  };
  const auto uses = [&](std::size_t servers) {
    return test::eventually([&] { return ask(30).size() == servers; }, 20s);
  };
  ASSERT_TRUE(uses(3));
  // On a crowded machine one may seem silent for a moment.
  EXPECT_TRUE(test::eventually(
      [&] {
        const std::map<std::uint64_t, int> answered = ask(300);
        return answered.size() == 3 &&
               std::ranges::all_of(answered, [](const auto& entry) { return std::abs(entry.second - 100) <= 20; });
      },
      20s));

  // What a command of its own did is in the answer, though a replica is told a moment later: the primary is asked. A replica is
  // asked again once it has shown the world of a whole second after the command, which it does a second late.
  const std::uint64_t primary = member("primary").server;
  for (int i = 1; i <= 5; ++i) {
    ASSERT_TRUE(client.add(
        {.name = "post_" + std::to_string(i), .shape = {SphereShape{.radius_m = 0.2}}, .pose = at(i, 0, 50)}));
    const auto changed = std::chrono::steady_clock::now();
    for (int again = 0; again < 10; ++again) {
      const Result<Answers> seen = look(i);
      ASSERT_TRUE(seen) << seen.error().message;
      ASSERT_EQ(seen->answers[0].verdict, Verdict::hit) << "post " << i;
      if (std::chrono::steady_clock::now() - changed < 1s) { ASSERT_EQ(seen->server, primary); }
    }
  }
  ASSERT_TRUE(uses(3));

  // A settled instant does not go back.
  std::chrono::nanoseconds newest{0};
  for (int i = 0; i < 200; ++i) {
    const Result<Answers> settled = look(0, {.as_of = {Instant::Kind::settled}});
    ASSERT_TRUE(settled) << settled.error().message;
    EXPECT_GE(settled->world_time, newest);
    newest = settled->world_time;
  }

  // A killed one, and one that stands still.
  replicas_[0]->signal(SIGKILL);
  ask(200);
  EXPECT_TRUE(uses(2));
  replicas_[1]->signal(SIGSTOP);
  ask(50);
  EXPECT_TRUE(uses(1));
  replicas_[1]->signal(SIGCONT);
  EXPECT_TRUE(uses(2));
}

// What comes while it stands still it may lack, and nobody has told it yet.
TEST_F(ServerReplica, OneThatStoodStillAnswersNothingBeforeItsWorldWasFoundTheSame) {
  ChildProcess& primary = start({"--member", "primary"});
  ChildProcess& east = start_replica("east");
  const Ended same_name = run({"--domain", std::to_string(domain_), "--replica-of", "collided", "--member", "east",
                               "--state-dir", folder_.path() + "/second"});
  EXPECT_EQ(same_name.code, 2);
  EXPECT_NE(same_name.errors.find("use another --member"), std::string::npos) << same_name.errors;
  Client client = connect_alone("collided/replica_east");
  const auto look = [&] { return client.ask(RayQuestion{.origin = {0, 0, 50}, .direction = {0, 0, -1}}); };
  ASSERT_TRUE(test::eventually([&] { return !!look(); }, 40s)) << east.errors();
  east.signal(SIGSTOP);
  std::this_thread::sleep_for(500ms);
  east.signal(SIGCONT);
  const Result<Answer> first = look();
  ASSERT_FALSE(first);
  EXPECT_EQ(first.error().code, ErrorCode::refused) << first.error().message;
  EXPECT_TRUE(test::eventually([&] { return !!look(); }, 40s)) << east.errors();

  // While there is no primary it answers, for a while.
  Client spread = connect();
  const auto answer = [&] {
    return spread.ask(std::vector{RayQuestion{.origin = {0, 0, 50}, .direction = {0, 0, -1}}});
  };
  const std::uint64_t replica = member("east").server;
  ASSERT_TRUE(test::eventually(
      [&] {
        const Result<Answers> one = answer();
        return one && one->server == replica;
      },
      20s));
  primary.signal(SIGKILL);
  for (int i = 0; i < 10; ++i) {
    const Result<Answers> one = answer();
    ASSERT_TRUE(one) << one.error().message;
    EXPECT_EQ(one->server, replica);
  }

  // Another primary need not have what this one had.
  primary.wait(5s);
  start({"--member", "primary"}, "again");
  EXPECT_EQ(east.wait(20s), 3) << east.errors();
  EXPECT_NE(east.errors().find("'primary' is primary now"), std::string::npos) << east.errors();
}

// Whoever has taken the primary's place by the same changes is followed from there on: nobody starts the replica again, and
// what commands do afterwards it does too.
TEST_F(ServerReplica, OneFollowsWhoeverTakesThePrimarysPlace) {
  const auto start_member = [&](const std::string& name, const std::vector<std::string>& options) -> ChildProcess& {
    std::vector<std::string> words{COLLIDED_SERVER,
                                   "--domain",
                                   std::to_string(domain_),
                                   "--member",
                                   name,
                                   "--state-dir",
                                   elsewhere_.path() + "/" + name};
    words.insert(words.end(), options.begin(), options.end());
    servers_.push_back(std::make_unique<ChildProcess>(words, elsewhere_.path(), name));
    EXPECT_TRUE(servers_.back()->says("ready:", 20s)) << servers_.back()->errors();
    return *servers_.back();
  };
  ChildProcess* primary = &start_member("m0", {});
  ChildProcess& east = start_replica("east");
  Client client = connect();
  Client replica = connect_alone("collided/replica_east");
  const auto add_wall = [&](int number) {
    return !!client.add({.name = "wall " + std::to_string(number),
                         .shape = {BoxShape{.half_m = {0.5, 0.5, 0.5}}},
                         .pose = {.position = {10.0 * number, 0, 0}}});
  };
  const auto replica_has = [&](int number) {
    const Result<Answer> answer = replica.ask(RayQuestion{.origin = {10.0 * number, 0, 50}, .direction = {0, 0, -1}});
    return answer && answer->verdict == Verdict::hit && answer->hits[0].object == "wall " + std::to_string(number);
  };
  ASSERT_TRUE(add_wall(0));
  ASSERT_TRUE(becomes_ready("east")) << east.errors();
  for (int round = 1; round <= 2; ++round) {
    const std::string name = "m" + std::to_string(round);
    ASSERT_TRUE(add_wall(2 * round - 1));
    ChildProcess& standby = start_member(name, {"--standby-of", "collided"});
    ASSERT_TRUE(becomes_ready(name)) << standby.errors();
    // In turns it dies and hands over.
    primary->signal(round % 2 == 1 ? SIGKILL : SIGTERM);
    ASSERT_TRUE(test::eventually([&] { return member(name).role == FleetRole::primary; }, 20s)) << standby.errors();
    ASSERT_TRUE(test::eventually([&] { return add_wall(2 * round); }, 20s));
    ASSERT_TRUE(test::eventually([&] { return replica_has(2 * round) && replica_has(2 * round - 1); }, 20s))
        << east.errors();
    EXPECT_TRUE(becomes_ready("east")) << member("east").alarm;
    EXPECT_EQ(east.wait(0s), -1) << "it was to go on: " << east.errors();
    primary = &standby;
  }
}

}  // namespace
}  // namespace collided
