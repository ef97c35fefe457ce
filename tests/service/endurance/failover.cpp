// A standby takes the place of a primary again and again, beside a publisher that moves, a watch and a client that asks:
//   failover SERVER[,OTHER] ROUNDS [SEED] [kill|stop|hand_over] [TAKE_OVER_MS] [strict|fast|none] [STANDBYS]
// OTHER: a server of another version; members are of the two by turns, so that each takes over from the other.
// kill: the primary is killed. stop: it is stopped, and goes on at once or at a random moment after its place was taken. hand_over: it is
// told to end, and no question may fail. strict, fast: beside an etcd that says who is the primary; exits 77 where none is
// installed.
// STANDBYS: so many stand by at a time, 1. Each round one of them takes the place; the others follow that one, and a new one is
// started. The contacts are known: a ball that crosses a post's
// surface between two poses touches it, or parts from it, once. Prints the gaps, and exits 1 where an event was lost, told twice,
// told only as a difference (resync), out of order or of a lower epoch, or an answer was wrong.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "collided/fleet.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/endurance/measuring.hpp"
#include "tests/service/etcd_process.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;

constexpr int kBalls = 8;
constexpr auto kTick = 5ms;
constexpr auto kPatience = 40s;
constexpr int kMostShown = 20;

/// What was told of each ball, in order, and when.
struct Heard {
  std::map<std::string, std::vector<EventKind>> by_ball;
  std::map<std::string, std::vector<std::string>> in_words;  // the same, with where each comes from
  std::vector<SteadyClock::time_point> first_of_epoch;
  std::uint64_t epoch = 0;
  int lower_epochs = 0;
  int resyncs = 0;
};

class Failover {
 public:
  enum class How { kill, stop, hand_over };
  /// authority_mode  empty: without an authority
  /// servers  programs, which members are of by turns
  Failover(std::vector<std::string> servers, std::uint64_t seed, How how, std::string take_over_ms,
           const std::string& authority_mode, std::size_t standby_count)
      : random_(seed),
        domain_(own_domain()),
        servers_(std::move(servers)),
        how_(how),
        take_over_ms_(std::move(take_over_ms)),
        standby_count_(standby_count) {
    if (!authority_mode.empty()) {
      etcd_.emplace(1, folder_.path());
      if (!etcd_->is_ready(20s)) std::printf("etcd does not start: %s\n", etcd_->member(0).output().c_str());
      authority_ = {"--authority", etcd_->address(), "--authority-mode", authority_mode};
    }
    primary_ = start(false);
    client_.emplace(value_of(Client::connect({.domain = domain_, .wait = 20s}), "connect"));
    publisher_.emplace(value_of(client_->publish("balls", {.lease = 60s}), "publish"));
    for (int i = 0; i < kBalls; ++i) {
      add("post " + std::to_string(i), {3.0 * i, 0, 50});
      balls_.push_back(add(ball(i), {3.0 * i, 1, 50}));
    }
    is_touching_.assign(kBalls, false);
    watch_.emplace(value_of(client_->watch(), "watch"));
    if (!wait_until([&] { return watch_->in_step(); }, kPatience)) std::printf("the watch does not come in step\n");
    value_of(client_->command("add", R"({"name": "wall", "pose": [0, 0, 80, 1, 0, 0, 0]})",
                              {BoxShape{.half_m = {1, 50, 1}}}, 10s),
             "add");
  }

  /// Runs all rounds; returns how many faults were found.
  int run(int rounds) {
    std::thread mover([this] { move_until_over(); });
    std::thread listener([this] { listen_until_over(); });
    std::thread asker([this] { ask_until_over(); });
    int faults = 0;
    int done = 0;
    for (; done < rounds && faults == 0; ++done) faults += one_round(done);
    is_moving_.store(false);
    mover.join();
    std::this_thread::sleep_for(1s);
    is_over_.store(true);
    listener.join();
    asker.join();
    return faults + report(done);
  }

 private:
  static std::string ball(int i) { return "ball " + std::to_string(i); }
  Publisher::Object add(const std::string& name, const Vec3& where) {
    return value_of(
        publisher_->add({.name = name, .shape = {SphereShape{.radius_m = 0.25}}, .pose = {.position = where}}), "add");
  }
  std::uint64_t below(std::uint64_t bound) {
    const std::lock_guard lock(random_mutex_);
    return random_() % bound;
  }
  std::unique_ptr<ChildProcess> start(bool stands_by) {
    const std::string& server = servers_[static_cast<std::size_t>(started_) % servers_.size()];
    const std::string name = "m" + std::to_string(started_++);
    std::vector<std::string> words{server,
                                   "--domain",
                                   std::to_string(domain_),
                                   "--member",
                                   name,
                                   "--state-dir",
                                   folder_.path() + "/" + name,
                                   "--take-over-after",
                                   take_over_ms_ + "ms"};
    words.insert(words.end(), authority_.begin(), authority_.end());
    if (stands_by) words.insert(words.end(), {"--standby-of", "collided"});
    auto process = std::make_unique<ChildProcess>(words, folder_.path(), name);
    if (!process->says("ready:", 20s)) std::printf("%s does not start: %s\n", name.c_str(), process->errors().c_str());
    return process;
  }
  std::optional<FleetMember> member(const std::string& name) const {
    const Result<Fleet> all = fleet({.domain = domain_});
    if (!all) return std::nullopt;
    const auto found = std::ranges::find(all->members, name, &FleetMember::name);
    return found == all->members.end() ? std::nullopt : std::optional(*found);
  }

  bool becomes_ready(const std::string& name) const {
    return wait_until(
        [&] {
          const std::optional<FleetMember> one = member(name);
          return one && one->state == "ready" && one->hash_time != 0s;
        },
        kPatience);
  }
  std::string errors_of_standbys() const {
    std::string all;
    for (const auto& [name, standby] : standbys_) all += name + ": " + standby->errors() + "\n";
    return all;
  }
  /// The one of the standbys that is the primary now; null: none is. Where the machine stood still two may have taken the place;
  /// the one with the lower epoch gives way.
  std::unique_ptr<ChildProcess> take_heir() {
    std::string heir = standbys_.size() == 1 ? standbys_.begin()->first : std::string();
    static_cast<void>(wait_until(
        [&] {
          std::uint64_t greatest = 0;
          for (const auto& [name, standby] : standbys_) {
            if (standbys_.size() == 1) break;
            const std::optional<FleetMember> one = member(name);
            if (!one || one->role != FleetRole::primary || one->epoch < greatest) continue;
            greatest = one->epoch;
            heir = name;
          }
          return !heir.empty();
        },
        kPatience));
    if (heir.empty()) return nullptr;
    std::unique_ptr<ChildProcess> process = std::move(standbys_[heir]);
    standbys_.erase(heir);
    return process;
  }
  void drop_those_that_gave_way() {
    given_way_ += static_cast<int>(std::erase_if(
        standbys_, [](const auto& entry) { return entry.second->wait(std::chrono::milliseconds(1)) == 3; }));
  }

  int one_round(int round) {
    drop_those_that_gave_way();
    while (standbys_.size() < standby_count_) {
      const std::string name = "m" + std::to_string(started_);
      standbys_[name] = start(true);
    }
    for (const auto& [name, standby] : standbys_) {
      if (becomes_ready(name)) continue;
      std::printf("round %d: %s does not become ready: %s\n", round, name.c_str(), errors_of_standbys().c_str());
      return 1;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(below(400)));
    primary_->signal(how_ == How::kill ? SIGKILL : how_ == How::stop ? SIGSTOP : SIGTERM);
    const auto failed_at = SteadyClock::now();
    failures_.push_back(failed_at);
    const bool is_replaced = standby_speaks(failed_at);
    if (!is_replaced) {
      std::printf("round %d: nobody takes its place: %s\n", round, errors_of_standbys().c_str());
      return 1;
    }
    int faults = 0;
    if (how_ == How::stop) {
      // Half of them at once: it speaks before it learns that it has lost its place.
      std::this_thread::sleep_for(std::chrono::milliseconds(below(2) == 0 ? 0 : below(1'500)));
      primary_->signal(SIGCONT);
    }
    if (how_ != How::kill) {
      const int code = primary_->wait(20s);
      const bool is_right = code == (how_ == How::stop ? 3 : 0);
      if (!is_right) std::printf("round %d: it ends with %d: %s\n", round, code, primary_->errors().c_str());
      faults += is_right ? 0 : 1;
    }
    primary_ = take_heir();
    if (primary_) return faults;
    std::printf("round %d: none of them is the primary: %s\n", round, errors_of_standbys().c_str());
    return faults + 1;
  }

  bool standby_speaks(SteadyClock::time_point since) {
    return wait_until(
        [&] {
          const std::lock_guard lock(heard_mutex_);
          return !heard_.first_of_epoch.empty() && heard_.first_of_epoch.back() > since;
        },
        std::chrono::duration_cast<std::chrono::milliseconds>(kPatience));
  }

  /// Every ball goes to its post and away again, each at moments of its own.
  void move_until_over() {
    auto due = SteadyClock::now();
    while (is_moving_.load()) {
      due += kTick;
      std::this_thread::sleep_until(due);
      for (std::size_t i = 0; i < kBalls; ++i) {
        if (below(16) == 0) {
          is_touching_[i] = !is_touching_[i];
          const std::lock_guard lock(expected_mutex_);
          expected_[ball(static_cast<int>(i))].push_back(is_touching_[i] ? EventKind::began : EventKind::ended);
          moved_at_[ball(static_cast<int>(i))].push_back(since_1970());
        }
        const double away_m = is_touching_[i] ? 0.4 : 0.8 + 0.01 * static_cast<double>(below(10));
        static_cast<void>(publisher_->move(balls_[i], {.position = {3.0 * static_cast<double>(i), away_m, 50}}));
      }
      // While nobody serves for longer than its messages have room, it refuses; what was not sent is no move yet.
      while (!publisher_->flush()) std::this_thread::sleep_for(kTick);
    }
    for (int i = 0; i < 20; ++i) {
      static_cast<void>(publisher_->keep_alive());
      std::this_thread::sleep_for(50ms);
    }
  }

  void listen_until_over() {
    while (!is_over_.load()) {
      const std::optional<Event> event = watch_->next(100ms);
      if (!event) continue;
      const auto now = SteadyClock::now();
      const std::lock_guard lock(heard_mutex_);
      if (event->epoch > heard_.epoch && heard_.epoch != 0) heard_.first_of_epoch.push_back(now);
      if (event->epoch > heard_.epoch) since_ = now;
      heard_.lower_epochs += event->epoch < heard_.epoch ? 1 : 0;
      heard_.epoch = std::max(heard_.epoch, event->epoch);
      const std::string& name = event->a.starts_with("ball") ? event->a : event->b;
      if (event->resync && ++heard_.resyncs <= kMostShown)
        std::printf("only as a difference: %s %s, %.3f s into epoch %llu, event %llu of it\n", name.c_str(),
                    event->kind == EventKind::began ? "began" : "ended",
                    std::chrono::duration<double>(now - since_).count(), static_cast<unsigned long long>(event->epoch),
                    static_cast<unsigned long long>(event->sequence));
      heard_.by_ball[name].push_back(event->kind);
      heard_.in_words[name].push_back((event->kind == EventKind::began ? "began" : "ended") + std::string(" by ") +
                                      std::to_string(happened(*event).count()) + ", event " +
                                      std::to_string(event->sequence) + " of epoch " + std::to_string(event->epoch));
    }
  }

  void ask_until_over() {
    const RayQuestion ray{.origin = {-9, 0, 80}, .direction = {1, 0, 0}, .length_m = 100};
    while (!is_over_.load()) {
      const Result<Answer> answer = client_->ask(ray, {.timeout = 5s});
      if (answer) {
        ++answered_;
        const bool is_right = answer->verdict == Verdict::hit && answer->hits.size() == 1 &&
                              std::abs(answer->hits[0].distance_m - 8) < 1e-9;
        wrong_ += is_right ? 0 : 1;
      } else {
        ++unanswered_[answer.error().message.substr(0, 60)];
      }
      std::this_thread::sleep_for(2ms);
    }
  }

  static std::chrono::nanoseconds since_1970() { return std::chrono::system_clock::now().time_since_epoch(); }
  /// What was heard about where it first differs from what was done.
  void show_difference(const std::string& name) {
    const std::vector<EventKind>& expected = expected_[name];
    const std::vector<std::chrono::nanoseconds>& moved = moved_at_[name];
    const std::vector<std::string>& words = heard_.in_words[name];
    // Kinds alternate, so that what is missing shows in the times alone: on the way from the pose before.
    std::size_t i = 1;
    for (; i < std::min(moved.size(), words.size()); ++i) {
      const std::int64_t by_ns = std::strtoll(words[i].c_str() + words[i].find("by ") + 3, nullptr, 10);
      if (by_ns < moved[i - 1].count() - 1'000'000 || by_ns > moved[i].count() + 1'000'000) break;
    }
    const std::size_t first = i < 3 ? 0 : i - 3;
    std::printf("%s: %zu moves, %zu events; from the %zuth on\n", name.c_str(), expected.size(), words.size(), first);
    for (std::size_t k = first; k < std::min(expected.size(), first + 9); ++k)
      std::printf("  %s at %lld; told: %s\n", expected[k] == EventKind::began ? "touches" : "parts",
                  static_cast<long long>(moved[k].count()), k < words.size() ? words[k].c_str() : "nothing");
  }

  int report(int rounds) {
    int lost = 0, doubled = 0, unlike = 0;
    std::size_t events = 0;
    for (const auto& [name, expected] : expected_) {
      const std::vector<EventKind>& heard = heard_.by_ball[name];
      events += expected.size();
      lost += std::max(0, static_cast<int>(expected.size()) - static_cast<int>(heard.size()));
      doubled += std::max(0, static_cast<int>(heard.size()) - static_cast<int>(expected.size()));
      unlike += heard == expected ? 0 : 1;
      if (heard != expected) show_difference(name);
    }
    std::vector<double> gaps_ms;
    for (std::size_t i = 0; i < std::min(failures_.size(), heard_.first_of_epoch.size()); ++i)
      gaps_ms.push_back(std::chrono::duration<double, std::milli>(heard_.first_of_epoch[i] - failures_[i]).count());
    std::printf(
        "%d rounds, %zu events: %d lost, %d doubled, %d of %d balls told otherwise, %d only as a difference, "
        "%d of a lower epoch\n",
        rounds, events, lost, doubled, unlike, kBalls, heard_.resyncs, heard_.lower_epochs);
    std::printf("from the failure to the next one's first event: p50 %.0f ms, p99 %.0f ms, longest %.0f ms\n",
                percentile(gaps_ms, 0.5), percentile(gaps_ms, 0.99), percentile(gaps_ms, 1));
    std::printf("%zu questions answered, %zu of them wrong\n", answered_, wrong_);
    if (standby_count_ > 1) std::printf("%d took the place beside another one, and gave way\n", given_way_);
    for (const auto& [why, count] : unanswered_) std::printf("  %zu not answered: %s...\n", count, why.c_str());
    const int failed = how_ == How::hand_over ? static_cast<int>(unanswered_.size()) : 0;
    return lost + doubled + unlike + heard_.resyncs + heard_.lower_epochs + static_cast<int>(wrong_) + failed;
  }

  std::mutex random_mutex_;
  std::mt19937_64 random_;
  ScratchFolder folder_;
  std::optional<EtcdCluster> etcd_;
  std::vector<std::string> authority_;  // options of each server
  const int domain_;
  const std::vector<std::string> servers_;
  const How how_;
  const std::string take_over_ms_;
  const std::size_t standby_count_;
  int started_ = 0;
  int given_way_ = 0;  // of those that stood by
  std::unique_ptr<ChildProcess> primary_;
  std::map<std::string, std::unique_ptr<ChildProcess>> standbys_;  // by name of the member
  std::optional<Client> client_;
  std::optional<Publisher> publisher_;
  std::optional<Watch> watch_;
  std::vector<Publisher::Object> balls_;
  std::vector<bool> is_touching_;
  std::vector<SteadyClock::time_point> failures_;
  std::atomic<bool> is_moving_{true};
  std::atomic<bool> is_over_{false};
  std::mutex expected_mutex_;
  std::map<std::string, std::vector<EventKind>> expected_;
  std::map<std::string, std::vector<std::chrono::nanoseconds>> moved_at_;  // of each of them, since 1970
  std::mutex heard_mutex_;
  Heard heard_;
  SteadyClock::time_point since_;  // the first event of the epoch; of the listening thread
  std::size_t answered_ = 0;       // these three are of the asking thread
  std::size_t wrong_ = 0;
  std::map<std::string, std::size_t> unanswered_;
};

}  // namespace
}  // namespace collided::testing_support

int main(int count, char** words) {
  using namespace collided::testing_support;
  if (count < 3) return 2;
  const std::uint64_t seed = count > 3 ? std::strtoull(words[3], nullptr, 10) : 28;
  using How = Failover::How;
  const std::string how = count > 4 ? words[4] : "kill";
  const std::string authority_mode = count > 6 && words[6] != std::string("none") ? words[6] : "";
  const std::size_t standby_count = count > 7 ? std::strtoull(words[7], nullptr, 10) : 1;
  if (!authority_mode.empty() && !has_etcd()) return 77;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  std::fflush(stdout);
  std::vector<std::string> servers(1);
  for (const char* letter = words[1]; *letter != '\0'; ++letter)
    *letter == ',' ? static_cast<void>(servers.emplace_back()) : servers.back().push_back(*letter);
  Failover failover(servers, seed,
                    how == "stop"        ? How::stop
                    : how == "hand_over" ? How::hand_over
                                         : How::kill,
                    count > 5 ? words[5] : "200", authority_mode, standby_count);
  return failover.run(std::atoi(words[2])) == 0 ? 0 : 1;
}
