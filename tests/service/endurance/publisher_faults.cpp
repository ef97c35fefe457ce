// Publishers that are killed, frozen, restarted, and that fight over names, again and again beside healthy ones:
//   publisher_faults SERVER ROUNDS
// Prints one line; exits 1 where an object outlived its publisher, a loss was told late or where there was none, or a
// name changed hands while its first owner lived.

#include <sys/prctl.h>
#include <sys/wait.h>

#include <csignal>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/service/child_process.hpp"
#include "tests/service/endurance/measuring.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;
using Pair = std::pair<std::string, std::string>;

constexpr int kOwners = 3;
constexpr double kRivalOffset_m = 1'000;
constexpr auto kPatience = 10s;
constexpr double kMostFlagged_ms = 600;
/// Of a publisher on a machine too busy to run it in time the server says rightly that it is lost.
constexpr double kLongestPause_ms = 400;

// ---- the publisher's process

/// Two balls that touch for ever, one that meets a post ten times a second, and one that is kept when its publisher is lost.
int run_publisher(int domain, const std::string& name, double x) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  Client client = value_of(Client::connect({.domain = domain, .wait = 10s}), "connect");
  Publisher publisher = value_of(client.publish(name), "publish");
  const auto ball = [&](const char* what, const Vec3& at, LostPolicy lost_policy) {
    return value_of(publisher.add({.name = name + "/" + what,
                                   .shape = {SphereShape{.radius_m = 0.5}},
                                   .pose = {.position = at},
                                   .lost_policy = lost_policy}),
                    "add");
  };
  ball("a", {x, 0, 100}, LostPolicy::remove);
  ball("b", {x + 0.5, 0, 100}, LostPolicy::remove);
  ball("post", {x, 20, 100}, LostPolicy::remove);
  const Publisher::Object mover = ball("mover", {x, 25, 100}, LostPolicy::remove);
  ball("kept", {x, 10, 100}, LostPolicy::freeze);
  std::printf("up\n");
  std::fflush(stdout);
  auto last = SteadyClock::now();
  for (int i = 0;; ++i) {
    static_cast<void>(publisher.move(mover, {.position = {x, i % 10 < 5 ? 25.0 : 20.9, 100}}));
    static_cast<void>(publisher.flush());
    if (ms_since(last) > kLongestPause_ms) std::printf("paused\n"), std::fflush(stdout);
    last = SteadyClock::now();
    std::this_thread::sleep_for(10ms);
  }
}

// ---- who watches them

/// What one subscriber was told.
class Told {
 public:
  void hear(const Event& event) {
    const std::lock_guard lock(mutex_);
    const Pair pair = std::minmax(event.a, event.b);
    const bool ended = event.kind == EventKind::ended;
    unpaired_ += (ended ? open_.erase(pair) == 1 : open_.emplace(pair, event.kind).second) ? 0 : 1;
    if (!ended) return;
    ended_.push_back({event.a.substr(0, event.a.find('/')), event.reason});
  }
  bool holds(const std::string& publisher) {
    const std::lock_guard lock(mutex_);
    return open_.contains({publisher + "/a", publisher + "/b"});
  }
  /// Since the last call.
  std::vector<std::string> take_lost() {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> lost;
    for (const auto& [publisher, why] : ended_) {
      if (why == EndReason::publisher_lost) lost.push_back(publisher);
    }
    ended_.clear();
    return lost;
  }
  int unpaired() {
    const std::lock_guard lock(mutex_);
    return unpaired_;
  }

 private:
  std::mutex mutex_;
  std::map<Pair, EventKind> open_;
  std::vector<std::pair<std::string, EndReason>> ended_;
  int unpaired_ = 0;
};

class PublisherFaults {
 public:
  PublisherFaults(std::string self, const std::string& server)
      : self_(std::move(self)),
        domain_(own_domain()),
        server_({server, "--domain", std::to_string(domain_), "--state-dir", folder_.path(), "--forget-after", "0"},
                folder_.path(), "server") {
    if (!server_.says("ready:", 20s)) std::exit(2);
    client_.emplace(value_of(Client::connect({.domain = domain_, .wait = 10s}), "connect"));
    watch_.emplace(value_of(client_->watch({}, [this](const Event& event) { reported_.hear(event); }), "watch"));
    for (int i = 0; i < kOwners; ++i) {
      owners_.push_back(start(name_of(i), place_of(i)));
      await(wait_until([&] { return reported_.holds(name_of(i)); }, kPatience), "an owner's contact");
    }
  }

  void round(int number) {
    const int victim = static_cast<int>(random_() % kOwners);
    switch (number % 5) {
      case 0: kill_one(victim); break;
      case 1: freeze_one(victim); break;
      case 2: restart_at_once(victim); break;
      case 3: fight(victim); break;
      default: take_over(victim);
    }
    count_ghosts();
    count_spurious();
  }

  int report(int rounds) {
    const int unpaired = reported_.unpaired();
    const double flagged_max = percentile(flagged_ms_, 1);
    std::printf(
        "rounds=%d ghosts=%d flagged_p50=%.0f flagged_max=%.0f spurious_ended=%d flips=%d unpaired=%d late=%d\n",
        rounds, ghosts_, percentile(flagged_ms_, 0.5), flagged_max, spurious_, flips_, unpaired, late_);
    const bool kept = ghosts_ + spurious_ + flips_ + unpaired + late_ == 0 && flagged_max <= kMostFlagged_ms;
    if (!kept) std::fprintf(stderr, "the server said:\n%s", server_.errors().c_str());
    return kept ? 0 : 1;
  }

 private:
  using Process = std::unique_ptr<ChildProcess>;
  static std::string name_of(int owner) { return "owner" + std::to_string(owner); }
  static double place_of(int owner) { return 100.0 * owner; }

  Process start(const std::string& name, double x) {
    const std::string file = name + "_" + std::to_string(started_++);
    auto process = std::make_unique<ChildProcess>(
        std::vector<std::string>{self_, "--publish", std::to_string(domain_), name, std::to_string(x)}, folder_.path(),
        file);
    if (!process->says("up", 10s)) {
      std::fprintf(stderr, "%s did not start: %s\n", name.c_str(), process->errors().c_str());
      std::exit(2);
    }
    return process;
  }
  static void end(Process& process) {
    process->signal(SIGKILL);
    process->wait(5s);
  }
  /// Counts and says what did not come about.
  void await(bool holds, const char* what) {
    if (holds) return;
    ++late_;
    std::fprintf(stderr, "late: %s\n", what);
  }

  nlohmann::json objects(const std::string& glob) {
    const Result<std::string> text = client_->command("list", nlohmann::json{{"name", glob}}.dump());
    return text ? nlohmann::json::parse(*text)["objects"] : nlohmann::json::array();
  }
  bool is_stale(const std::string& name) {
    const nlohmann::json found = objects(name);
    return found.size() == 1 && found[0]["stale"].get<bool>();
  }
  bool is_fresh(const std::string& name) {
    const nlohmann::json found = objects(name);
    return found.size() == 1 && !found[0]["stale"].get<bool>();
  }
  /// Whether a ball of the publisher's is where one that lives at x has it.
  bool is_at(const std::string& name, double x) {
    const auto hits = [&](double y) {
      const Result<Answer> down = client_->ask(RayQuestion{.origin = {x, y, 200}, .direction = {0, 0, -1}});
      return down && down->verdict == Verdict::hit && down->hits[0].object.starts_with(name);
    };
    return hits(0) && hits(10);
  }

  /// From the fault on until the contact is said to have ended and the ball that stays is flagged.
  void expect_flagged(int owner, SteadyClock::time_point since) {
    const std::string name = name_of(owner);
    const bool ended = wait_until([&] { return !reported_.holds(name); }, kPatience, 1ms);
    await(ended, "a contact of a lost publisher ends");
    const bool flagged = wait_until([&] { return is_stale(name + "/kept"); }, kPatience, 1ms);
    await(flagged, "a kept object of a lost publisher is flagged");
    flagged_ms_.push_back(ms_since(since));
    lost_rightly_[name] += 1;
  }
  void expect_back(int owner) {
    const std::string name = name_of(owner);
    await(wait_until([&] { return reported_.holds(name); }, kPatience), "the contact of one that is back");
    await(wait_until([&] { return is_fresh(name + "/kept"); }, kPatience), "the kept object of one that is back");
  }

  void kill_one(int owner) {
    const auto since = SteadyClock::now();
    end(owners_[static_cast<std::size_t>(owner)]);
    expect_flagged(owner, since);
    count_ghosts({name_of(owner)});
    owners_[static_cast<std::size_t>(owner)] = start(name_of(owner), place_of(owner));
    expect_back(owner);
  }
  void freeze_one(int owner) {
    const auto since = SteadyClock::now();
    owners_[static_cast<std::size_t>(owner)]->signal(SIGSTOP);
    expect_flagged(owner, since);
    count_ghosts({name_of(owner)});
    owners_[static_cast<std::size_t>(owner)]->signal(SIGCONT);
    expect_back(owner);
  }
  void restart_at_once(int owner) {
    const auto since = SteadyClock::now();
    end(owners_[static_cast<std::size_t>(owner)]);
    owners_[static_cast<std::size_t>(owner)] = start(name_of(owner), place_of(owner));
    // The new one waits for its names until the old one is known to be lost.
    await(wait_until([&] { return !reported_.holds(name_of(owner)); }, kPatience, 1ms), "the old one's contact ends");
    flagged_ms_.push_back(ms_since(since));
    lost_rightly_[name_of(owner)] += 1;
    expect_back(owner);
  }
  /// The owner keeps its names however long the rival wants them.
  void fight(int owner) {
    Process rival = start(name_of(owner), place_of(owner) + kRivalOffset_m);
    for (int i = 0; i < 60; ++i) {
      flips_ += is_at(name_of(owner), place_of(owner)) ? 0 : 1;
      flips_ += is_at(name_of(owner), place_of(owner) + kRivalOffset_m) ? 1 : 0;
      std::this_thread::sleep_for(10ms);
    }
    end(rival);
    std::this_thread::sleep_for(700ms);
    flips_ += is_at(name_of(owner), place_of(owner)) ? 0 : 1;
  }
  /// The rival has the names once the owner is lost, and the owner has them back once the rival is.
  void take_over(int owner) {
    Process rival = start(name_of(owner), place_of(owner) + kRivalOffset_m);
    end(owners_[static_cast<std::size_t>(owner)]);
    await(wait_until([&] { return is_at(name_of(owner), place_of(owner) + kRivalOffset_m); }, kPatience),
          "the rival's turn");
    await(!is_at(name_of(owner), place_of(owner)), "the owner's objects are gone");
    owners_[static_cast<std::size_t>(owner)] = start(name_of(owner), place_of(owner));
    for (int i = 0; i < 20; ++i) {
      flips_ += is_at(name_of(owner), place_of(owner)) ? 1 : 0;
      std::this_thread::sleep_for(10ms);
    }
    end(rival);
    await(wait_until([&] { return is_at(name_of(owner), place_of(owner)); }, kPatience), "the owner's turn again");
    lost_rightly_[name_of(owner)] += 2;
    expect_back(owner);
  }

  /// Objects that were to go with their publisher, and all that nobody has brought.
  void count_ghosts(const std::vector<std::string>& dead = {}) {
    for (const nlohmann::json& object : objects("owner*")) {
      const std::string name = object["name"].get<std::string>();
      const std::string publisher = name.substr(0, name.find('/'));
      const bool is_dead = std::find(dead.begin(), dead.end(), publisher) != dead.end();
      const bool stays = name.ends_with("/kept");
      ghosts_ += is_dead && !stays ? 1 : 0;
    }
    const std::size_t expected = 5 * kOwners - 4 * dead.size();
    await(wait_until([&] { return objects("owner*").size() == expected; }, kPatience),
          "as many objects as there are to be");
  }
  /// Each of a lost publisher's contacts ends once for a loss; any more were none.
  void count_spurious() {
    for (const std::string& publisher : reported_.take_lost()) {
      const int owner = publisher.back() - '0';
      const bool was_paused = owners_[static_cast<std::size_t>(owner)]->output().find("paused") != std::string::npos;
      if (lost_rightly_.contains(publisher) || was_paused) continue;
      ++spurious_;
      std::fprintf(stderr, "spurious: %s\n", publisher.c_str());
    }
    lost_rightly_.clear();
  }

  std::string self_;
  ScratchFolder folder_;
  int domain_;
  ChildProcess server_;
  std::mt19937_64 random_{20261122};
  Told reported_;
  std::optional<Client> client_;
  std::optional<Watch> watch_;
  std::vector<Process> owners_;
  int started_ = 0;
  std::map<std::string, int> lost_rightly_;
  std::vector<double> flagged_ms_;
  int ghosts_ = 0;
  int spurious_ = 0;
  int flips_ = 0;
  int late_ = 0;
};

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  using namespace collided::testing_support;
  if (argc == 5 && std::string(argv[1]) == "--publish")
    return run_publisher(std::atoi(argv[2]), argv[3], std::atof(argv[4]));
  if (argc != 3) {
    std::fprintf(stderr, "usage: publisher_faults SERVER ROUNDS\n");
    return 2;
  }
  const int rounds = std::atoi(argv[2]);
  PublisherFaults faults(argv[0], argv[1]);
  for (int i = 0; i < rounds; ++i) {
    faults.round(i);
    if ((i + 1) % 50 == 0) std::fprintf(stderr, "%d of %d\n", i + 1, rounds);
  }
  return faults.report(rounds);
}
