// The server is killed without warning again and again, with three subscribers and a publisher that goes on moving:
//   kill_loop SERVER SCENE KILLS
// Prints one line and exits 1 where an end was lost, a beginning made up, or the two did not alternate.

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include <algorithm>
#include <chrono>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "collided/client.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/endurance/measuring.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;
using Pair = std::pair<std::string, std::string>;

constexpr int kBalls = 12;
constexpr double kRadius_m = 0.5;
constexpr auto kPatience = 20s;

/// What one subscriber was told.
class Subscriber {
 public:
  explicit Subscriber(Client client) : client_(std::move(client)), watch_(value_of(client_.watch(), "watch")) {}

  void hear_all() {
    while (const std::optional<Event> event = watch_.next(0ns)) {
      const Pair pair = std::minmax(event->a, event->b);
      const bool fits = event->kind == EventKind::ended ? open_.erase(pair) == 1 : open_.insert(pair).second;
      unpaired_ += fits ? 0 : 1;
    }
  }
  Client& client() { return client_; }
  const std::set<Pair>& open() const { return open_; }
  bool connected() const { return watch_.connected(); }
  int unpaired() const { return unpaired_; }

 private:
  Client client_;
  Watch watch_;
  std::set<Pair> open_;
  int unpaired_ = 0;
};

class KillLoop {
 public:
  KillLoop(std::string server, std::string scene)
      : server_path_(std::move(server)), scene_(std::move(scene)), domain_(own_domain()) {
    start();
    for (int i = 0; i < 3; ++i) subscribers_.push_back(std::make_unique<Subscriber>(connect()));
    publisher_ = std::make_unique<Publisher>(value_of(subscribers_[0]->client().publish("mover"), "publish"));
    for (int i = 0; i < kBalls; ++i) {
      balls_.push_back(value_of(publisher_->add({.name = "ball " + std::to_string(i),
                                                 .shape = {SphereShape{.radius_m = kRadius_m}},
                                                 .pose = {.position = {100.0 + 10 * i, 0, 0}}}),
                                "add"));
      positions_.emplace_back(100.0 + 10 * i, 0, 0);
    }
  }

  void kill_once(bool at_once) {
    wait_for_truth();
    for (std::uint64_t i = random_() % 4; i > 0; --i) move_all();
    std::this_thread::sleep_for(std::chrono::microseconds(random_() % 30'000));
    server_->signal(SIGKILL);
    const auto killed = SteadyClock::now();
    server_->wait(5s);
    if (!at_once) {
      // Nobody takes its place: how long until they know?
      while (ms_since(killed) < 2'000 &&
             std::any_of(subscribers_.begin(), subscribers_.end(), [](const auto& s) { return s->connected(); }))
        pump(1ms);
      detect_ms_.push_back(ms_since(killed));
    }
    const auto started = SteadyClock::now();
    start();
    wait([&] {
      const auto status = subscribers_[0]->client().status();
      return status && status->pid == static_cast<std::uint32_t>(server_->pid()) && status->state == "ready";
    });
    ready_ms_.push_back(ms_since(started));
    if (ready_ms_.back() > 2'000)
      std::fprintf(stderr, "ready only after %.0f ms:\n%s", ready_ms_.back(), server_->errors().c_str());
  }

  /// What every subscriber holds is what touches; counted where it does not become so.
  void wait_for_truth() {
    move_all();
    const std::set<Pair> truth = touching();
    const auto agrees = [&](const auto& s) { return s->open() == truth; };
    wait([&] { return std::all_of(subscribers_.begin(), subscribers_.end(), agrees); });
    for (const auto& subscriber : subscribers_) {
      for (const Pair& pair : subscriber->open()) lost_ended_ += truth.contains(pair) ? 0 : 1;
      for (const Pair& pair : truth) lost_began_ += subscriber->open().contains(pair) ? 0 : 1;
    }
  }

  int report(int kills) {
    wait_for_truth();
    int unpaired = 0;
    for (const auto& subscriber : subscribers_) unpaired += subscriber->unpaired();
    std::printf(
        "kills=%d lost_ended=%d lost_began=%d unpaired=%d detect_p50=%.0f detect_p99=%.0f ready_p50=%.0f "
        "ready_p99=%.0f\n",
        kills, lost_ended_, lost_began_, unpaired, percentile(detect_ms_, 0.5), percentile(detect_ms_, 0.99),
        percentile(ready_ms_, 0.5), percentile(ready_ms_, 0.99));
    return lost_ended_ + lost_began_ + unpaired == 0 ? 0 : 1;
  }

 private:
  void start() {
    server_ =
        std::make_unique<ChildProcess>(std::vector<std::string>{server_path_, scene_, "--domain",
                                                                std::to_string(domain_), "--state-dir", folder_.path()},
                                       folder_.path(), "server");
  }
  Client connect() const { return value_of(Client::connect({.domain = domain_, .wait = 20s}), "connect"); }

  /// Subscribers hear, the publisher says that it lives.
  void pump(std::chrono::milliseconds time) {
    for (const auto& subscriber : subscribers_) subscriber->hear_all();
    static_cast<void>(publisher_ && publisher_->keep_alive());
    std::this_thread::sleep_for(time);
  }
  template <class Condition>
  void wait(Condition&& condition) {
    const auto until = SteadyClock::now() + kPatience;
    while (!condition() && SteadyClock::now() < until) pump(5ms);
  }

  void move_all() {
    std::uniform_real_distribution<double> coordinate(0, 3);
    for (std::size_t i = 0; i < balls_.size(); ++i) {
      positions_[i] = Vec3(100 + coordinate(random_), coordinate(random_), coordinate(random_));
      static_cast<void>(publisher_->move(balls_[i], {.position = positions_[i]}));
    }
    static_cast<void>(publisher_->flush());
  }

  /// Nothing is on the border: a distance of exactly two radii has no chance here.
  std::set<Pair> touching() const {
    std::set<Pair> pairs;
    for (int i = 0; i < kBalls; ++i) {
      for (int j = i + 1; j < kBalls; ++j) {
        const bool touch =
            (positions_[static_cast<std::size_t>(i)] - positions_[static_cast<std::size_t>(j)]).norm() <= 2 * kRadius_m;
        if (touch) pairs.insert(std::minmax("ball " + std::to_string(i), "ball " + std::to_string(j)));
      }
    }
    return pairs;
  }

  std::string server_path_;
  std::string scene_;
  int domain_;
  ScratchFolder folder_;
  std::mt19937_64 random_{20261122};
  std::unique_ptr<ChildProcess> server_;
  std::vector<std::unique_ptr<Subscriber>> subscribers_;
  std::unique_ptr<Publisher> publisher_;
  std::vector<Publisher::Object> balls_;
  std::vector<Vec3> positions_;
  std::vector<double> detect_ms_;
  std::vector<double> ready_ms_;
  int lost_ended_ = 0;
  int lost_began_ = 0;
};

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: kill_loop SERVER SCENE KILLS\n");
    return 2;
  }
  const int kills = std::atoi(argv[3]);
  collided::testing_support::KillLoop loop(argv[1], argv[2]);
  for (int i = 0; i < kills; ++i) {
    loop.kill_once(i % 2 == 0);
    if ((i + 1) % 50 == 0) std::fprintf(stderr, "%d of %d\n", i + 1, kills);
  }
  return loop.report(kills);
}
