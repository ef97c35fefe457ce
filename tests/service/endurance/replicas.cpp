// Replicas that die and stand still again and again, while clients ask them and the primary:
//   replicas SERVER ROUNDS [SEED] [kill|stop]
// kill: a replica is killed, and started again. stop: it is stopped, and goes on at a random moment.
// What is right is known: a wall that stays, a place where nothing is, and a cart of a publisher that asks where it has just put
// it (`fresh`). Prints how long questions took and who answered them; exits 1 where one failed, was wrong, went back in settled
// time, or a replica was not asked again.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
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

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;

constexpr int kReplicas = 2;
constexpr int kAskers = 3;
constexpr auto kPatience = 60s;
constexpr int kMostShown = 20;
constexpr double kCartRadius_m = 0.25;

class ReplicaFaults {
 public:
  ReplicaFaults(std::string server, std::uint64_t seed, bool stops)
      : random_(seed), domain_(own_domain()), server_(std::move(server)), stops_(stops) {
    primary_ = start("primary", {});
    for (int i = 0; i < kReplicas; ++i) replicas_.push_back(start_replica(i));
    client_.emplace(value_of(Client::connect({.domain = domain_, .wait = 20s}), "connect"));
    value_of(
        client_->add({.name = "wall", .shape = {BoxShape{.half_m = {1, 50, 1}}}, .pose = {.position = {0, 0, 80}}}),
        "add");
    publisher_.emplace(value_of(client_->publish("carts", {.lease = 60s}), "publish"));
    cart_ = value_of(
        publisher_->add(
            {.name = "cart", .shape = {SphereShape{.radius_m = kCartRadius_m}}, .pose = {.position = {0, 0, 50}}}),
        "add");
  }

  /// Runs all rounds; returns how many faults were found.
  int run(int rounds) {
    std::vector<std::thread> askers;
    for (int i = 0; i < kAskers; ++i) askers.emplace_back([this] { ask_until_over(); });
    std::thread driver([this] { drive_until_over(); });
    int faults = all_are_asked("at the start") ? 0 : 1;
    int done = 0;
    for (; done < rounds && faults == 0; ++done) faults += one_round(done);
    is_over_.store(true);
    for (std::thread& asker : askers) asker.join();
    driver.join();
    return faults + report(done);
  }

 private:
  std::unique_ptr<ChildProcess> start(const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words{server_, "--domain",    std::to_string(domain_),    "--member",
                                   name,    "--state-dir", folder_.path() + "/" + name};
    words.insert(words.end(), more.begin(), more.end());
    auto process = std::make_unique<ChildProcess>(words, folder_.path(), name + "-" + std::to_string(started_++));
    if (!process->says("ready:", 20s)) std::printf("%s does not start: %s\n", name.c_str(), process->errors().c_str());
    return process;
  }
  std::unique_ptr<ChildProcess> start_replica(int number) {
    return start("replica_" + std::to_string(number), {"--replica-of", "collided"});
  }

  /// Whether all have answered something from now on.
  bool all_are_asked(const char* when) {
    {
      const std::lock_guard lock(mutex_);
      recent_.clear();
    }
    const auto count = [&] {
      const std::lock_guard lock(mutex_);
      return recent_.size();
    };
    const auto began = SteadyClock::now();
    if (wait_until([&] { return count() == kReplicas + 1; }, kPatience)) {
      back_ms_.push_back(ms_since(began));
      return true;
    }
    std::printf("%s: %zu of %d servers answer\n", when, count(), kReplicas + 1);
    return false;
  }

  int one_round(int round) {
    const auto number = static_cast<std::size_t>(random_() % kReplicas);
    std::this_thread::sleep_for(std::chrono::milliseconds(random_() % 500));
    replicas_[number]->signal(stops_ ? SIGSTOP : SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(random_() % 2'000));
    if (stops_) replicas_[number]->signal(SIGCONT);
    else replicas_[number] = start_replica(static_cast<int>(number));
    const std::string when = "round " + std::to_string(round);
    return all_are_asked(when.c_str()) ? 0 : 1;
  }

  Result<Answers> ask(const RayQuestion& ray, const AskOptions& options) {
    const auto began = SteadyClock::now();
    Result<Answers> answers = client_->ask(std::vector{ray}, options);
    const double took_ms = ms_since(began);
    const std::lock_guard lock(mutex_);
    took_ms_.push_back(took_ms);
    if (answers) ++answered_[answers->server], ++recent_[answers->server];
    else if (++failed_ <= kMostShown) std::printf("failed: %s\n", answers.error().message.c_str());
    return answers;
  }
  void judge(const Result<Answers>& answers, const char* what, Verdict right, double distance_m = 0) {
    if (!answers) return;
    const Answer& answer = answers->answers.front();
    const bool is_right = answer.verdict == right &&
                          (right == Verdict::miss || std::abs(answer.hits.front().distance_m - distance_m) < 1e-9);
    const std::lock_guard lock(mutex_);
    if (is_right || ++wrong_ > kMostShown) return;
    std::printf("wrong: %s: verdict %d, reason %d, by %016llx\n", what, static_cast<int>(answer.verdict),
                static_cast<int>(answer.reason), static_cast<unsigned long long>(answers->server));
  }
  void ask_until_over() {
    while (!is_over_.load()) {
      judge(ask({.origin = {10, 3, 80}, .direction = {-1, 0, 0}}, {}), "the wall", Verdict::hit, 9);
      judge(ask({.origin = {10, 3, 90}, .direction = {-1, 0, 0}}, {}), "nothing", Verdict::miss);
      std::this_thread::sleep_for(1ms);
    }
  }
  /// The publisher asks where its cart is, and how far everybody is.
  void drive_until_over() {
    std::chrono::nanoseconds newest{0};
    for (int step = 0; !is_over_.load(); ++step) {
      const double x = step % 1'000 * 0.01;
      static_cast<void>(publisher_->move(*cart_, {.position = {x, 0, 50}}));
      static_cast<void>(publisher_->flush());
      judge(ask({.origin = {x, -10, 50}, .direction = {0, 1, 0}}, {.fresh = true}), "its own cart", Verdict::hit,
            10 - kCartRadius_m);
      const Result<Answers> settled =
          ask({.origin = {10, 3, 80}, .direction = {-1, 0, 0}}, {.as_of = {Instant::Kind::settled}});
      if (settled && settled->world_time < newest) {
        const std::lock_guard lock(mutex_);
        ++went_back_;
      }
      if (settled) newest = std::max(newest, settled->world_time);
      std::this_thread::sleep_for(5ms);
    }
  }

  int report(int rounds) {
    std::printf("%d rounds; %zu questions: %d failed, %d wrong, %d settled instants went back\n", rounds,
                took_ms_.size(), failed_, wrong_, went_back_);
    std::printf(
        "questions took p50 %.2f, p99 %.1f, at most %.0f ms; a replica was asked again after p50 %.1f, at most %.1f "
        "s\n",
        percentile(took_ms_, 0.5), percentile(took_ms_, 0.99), percentile(took_ms_, 1),
        percentile(back_ms_, 0.5) / 1'000, percentile(back_ms_, 1) / 1'000);
    for (const auto& [server, count] : answered_)
      std::printf("%016llx answered %d\n", static_cast<unsigned long long>(server), count);
    return failed_ + wrong_ + went_back_;
  }

  std::mt19937_64 random_;
  ScratchFolder folder_;
  const int domain_;
  const std::string server_;
  const bool stops_;
  int started_ = 0;
  std::unique_ptr<ChildProcess> primary_;
  std::vector<std::unique_ptr<ChildProcess>> replicas_;
  std::optional<Client> client_;
  std::optional<Publisher> publisher_;
  std::optional<Publisher::Object> cart_;
  std::atomic<bool> is_over_{false};
  std::vector<double> back_ms_;
  std::mutex mutex_;  // for the rest
  std::vector<double> took_ms_;
  std::map<std::uint64_t, int> answered_, recent_;
  int failed_ = 0;
  int wrong_ = 0;
  int went_back_ = 0;
};

}  // namespace
}  // namespace collided::testing_support

int main(int count, char** words) {
  const std::vector<std::string> given(words + 1, words + count);
  if (given.size() < 2) return 2;
  const std::uint64_t seed = given.size() > 2 ? std::stoull(given[2]) : 28;
  std::printf("seed %s\n", std::to_string(seed).c_str());
  collided::testing_support::ReplicaFaults faults(given[0], seed, given.size() > 3 && given[3] == "stop");
  return faults.run(std::stoi(given[1])) == 0 ? 0 : 1;
}
