// A standby beside a primary whose world commands and publishers change at random; it starts in the middle of that:
//   standby_agrees SERVER ROUNDS [SEED]
// Prints a line for each round; exits 1 where the two do not come to hold the same world, or the standby says that it
// could not do something that the primary did.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "collided/fleet.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/endurance/measuring.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

constexpr int kMovers = 12;
constexpr int kNames = 6;  // few, so that objects are added, moved and removed under one name again and again
constexpr auto kPatience = 40s;

class Round {
 public:
  Round(const std::string& server, std::uint64_t seed)
      : random_(seed), domain_(own_domain()), server_(server), primary_(start("primary", {})) {
    client_.emplace(value_of(Client::connect({.domain = domain_, .wait = 20s}), "connect"));
    publisher_.emplace(value_of(client_->publish("movers", {.lease = 60s}), "publish"));
    wall_ = folder_.write("wall.obj", "v 0 0 40\nv 9 0 40\nv 0 9 40\nf 1 2 3\n");
  }

  /// Whether the two come to agree. Changes go on before the standby starts, while it fetches, and afterwards.
  bool agrees() {
    const int steps = 60 + below(100);
    const int starts_at = below(steps);
    std::unique_ptr<ChildProcess> standby;
    for (int step = 0; step < steps; ++step) {
      if (step == starts_at) standby = start("standby", {"--standby-of", "collided"});
      move_some();
      if (below(2) == 0) command();
      std::this_thread::sleep_for(std::chrono::milliseconds(below(30)));
    }
    const auto began = SteadyClock::now();
    Member primary, other;
    while (SteadyClock::now() - began < kPatience) {
      static_cast<void>(publisher_->keep_alive());
      const Result<Fleet> all = fleet({.domain = domain_});
      if (!all) continue;
      for (const Member& member : all->members) (member.name == "primary" ? primary : other) = member;
      const bool is_same = primary.hash_time != 0s && primary.hash_time == other.hash_time &&
                           primary.world_hash == other.world_hash &&
                           primary.scene_fingerprint == other.scene_fingerprint;
      if (!is_same || other.state != "ready") continue;
      std::printf("%d changes, %d refused, standby from step %d of %d: the same after %.1f s\n", done_, refused_,
                  starts_at, steps, ms_since(began) / 1'000);
      if (!other.alarm.empty()) std::printf("alarm: %s\n", other.alarm.c_str());
      return other.alarm.empty();
    }
    std::printf("no agreement: primary %s, standby %s, alarm '%s'\n%s\n", primary.state.c_str(), other.state.c_str(),
                other.alarm.c_str(), standby->errors().c_str());
    return false;
  }

 private:
  using Member = FleetMember;

  std::unique_ptr<ChildProcess> start(const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words{server_, "--domain", std::to_string(domain_), "--member", name, "--state-dir",
                                   folder_.path() + "/" + name,
                                   // It compares; a busy machine is no reason to change who is the primary.
                                   "--take-over-after", "never"};
    words.insert(words.end(), more.begin(), more.end());
    auto process = std::make_unique<ChildProcess>(words, folder_.path(), name);
    if (!process->says("ready:", 20s)) std::printf("%s does not start: %s\n", name.c_str(), process->errors().c_str());
    return process;
  }
  int below(int bound) { return static_cast<int>(random_() % static_cast<std::uint64_t>(bound)); }
  double metres() { return std::uniform_real_distribution<double>(-20, 20)(random_); }
  json pose() { return {metres(), metres(), 60 + metres(), 1, 0, 0, 0}; }
  std::string name() { return "thing_" + std::to_string(below(kNames)); }
  std::string mover() { return "mover_" + std::to_string(below(kMovers)); }

  /// Some of the publisher's objects; the rest rests where it is.
  void move_some() {
    if (movers_.empty()) {
      for (int i = 0; i < kMovers; ++i)
        movers_.push_back(value_of(publisher_->add({.name = "mover_" + std::to_string(i),
                                                    .shape = {SphereShape{.radius_m = 0.5}},
                                                    .pose = {.position = {metres(), metres(), 90}}}),
                                   "add"));
    }
    for (int i = below(4); i > 0; --i)
      static_cast<void>(
          publisher_->move(movers_[static_cast<std::size_t>(below(kMovers))], {.position = {metres(), metres(), 90}}));
    static_cast<void>(publisher_->flush());
  }

  /// One that the primary may refuse, too: then nothing is repeated.
  void command() {
    static const Shape kBall{SphereShape{.radius_m = 0.3}};
    const std::vector<std::function<Result<std::string>()>> all{
        [&] {
          return ask("add", {{"name", name()}, {"pose", pose()}}, kBall);
        },
        [&] {
          return ask("add", {{"name", name()}, {"pose", pose()}, {"layers", 1 + below(3)}}, kBall);
        },
        [&] {
          return ask("move", {{"name", name()}, {"pose", pose()}});
        },
        [&] {
          return ask("move", {{"name", name()}, {"pose", pose()}, {"teleport", true}});
        },
        [&] {
          return ask("remove", {{"name", name()}});
        },
        [&] {
          return ask("attach", {{"child", name()}, {"parent", mover()}});
        },
        [&] {
          return ask("detach", {{"child", name()}});
        },
        [&] {
          return ask("allow", {{"a", name()}, {"b", mover()}});
        },
        [&] {
          return ask("deny", {{"a", name()}, {"b", mover()}});
        },
        [&] {
          return ask("probe", {{"name", name()}, {"object", mover()}});
        },
        [&] {
          return ask("load", {{"path", wall_}, {"replace", true}});
        },
        [&] {
          return ask("clear", {{"scene", "wall"}});
        },
        [&] {
          return ask("clear", {{"moving", true}});
        },
    };
    const Result<std::string> answer = all[static_cast<std::size_t>(below(static_cast<int>(all.size())))]();
    ++(answer ? done_ : refused_);
  }
  Result<std::string> ask(const std::string& command, const json& arguments, const Shape& shape = {}) {
    return client_->command(command, arguments.dump(), shape, 10s);
  }

  std::mt19937_64 random_;
  ScratchFolder folder_;
  const int domain_;
  const std::string server_;
  std::unique_ptr<ChildProcess> primary_;
  std::optional<Client> client_;
  std::optional<Publisher> publisher_;
  std::vector<Publisher::Object> movers_;
  std::string wall_;
  int done_ = 0;
  int refused_ = 0;
};

}  // namespace
}  // namespace collided::testing_support

int main(int count, char** words) {
  using namespace collided::testing_support;
  if (count < 3) return 2;
  const int rounds = std::atoi(words[2]);
  const std::uint64_t seed = count > 3 ? std::strtoull(words[3], nullptr, 10) : 28;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  int failed = 0;
  for (int round = 0; round < rounds; ++round) {
    Round one(words[1], seed + static_cast<std::uint64_t>(round));
    failed += one.agrees() ? 0 : 1;
    std::fflush(stdout);
  }
  std::printf("%d of %d rounds agree\n", rounds - failed, rounds);
  return failed == 0 ? 0 : 1;
}
