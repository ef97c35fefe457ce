#include "tests/service/endurance/cut_witness.hpp"

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "collided/fleet.hpp"
#include "tests/service/endurance/measuring.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;

constexpr int kBalls = 4;
constexpr auto kPatience = 30s;

std::atomic<bool> is_over{false};
void end(int) { is_over.store(true); }

std::int64_t now_ns() { return std::chrono::nanoseconds(SteadyClock::now().time_since_epoch()).count(); }

class CutWitness {
 public:
  CutWitness(int domain, const std::string& interface, const std::string& name)
      : where_({.domain = domain, .interface = interface, .wait = kPatience}),
        client_(value_of(Client::connect(where_), "connect")),
        publisher_(value_of(client_.publish("balls of " + name, {.lease = 60s}), "publish")),
        watch_(value_of(client_.watch(), "watch")) {
    // Each witness has a row of its own.
    const double row = name == "a" ? 0 : 100;
    for (int i = 0; i < kBalls; ++i) {
      const std::string number = name + std::to_string(i);
      places_.push_back({3.0 * i, row, 50});
      value_of(publisher_.add({.name = "post " + number,
                               .shape = {SphereShape{.radius_m = 0.25}},
                               .pose = {.position = places_.back()}}),
               "add");
      balls_.push_back(value_of(publisher_.add({.name = "ball " + number,
                                                .shape = {SphereShape{.radius_m = 0.25}},
                                                .pose = {.position = places_.back() + Vec3(0, 1, 0)}}),
                                "add"));
    }
  }

  /// The balls touch and part in turn, every 10 ms one of them.
  void move() {
    std::vector<bool> touches(kBalls, false);
    for (std::size_t turn = 0; !is_over.load(); ++turn) {
      const std::size_t i = turn % kBalls;
      touches[i] = !touches[i];
      static_cast<void>(publisher_.move(balls_[i], {.position = places_[i] + Vec3(0, touches[i] ? 0.4 : 0.9, 0)}));
      static_cast<void>(publisher_.flush());
      std::this_thread::sleep_for(10ms);
    }
  }

  void listen() {
    while (!is_over.load()) {
      const std::optional<Event> event = watch_.next(100ms);
      // What a watch finds out by comparing states was said by nobody.
      if (event && !event->resync) say("%s %llu %lld\n", kEventLine, event->epoch, now_ns());
    }
  }

  void ask() {
    const std::vector<RayQuestion> ray{{.origin = {-9, 0, 80}, .direction = {1, 0, 0}, .length_m = 100}};
    while (!is_over.load()) {
      const std::int64_t asked = now_ns();
      const Result<Answers> answers = client_.ask(ray, {.timeout = 300ms});
      if (answers) {
        const Answer& answer = answers->answers.front();
        const bool is_right =
            answer.verdict == Verdict::hit && answer.hits.size() == 1 && std::abs(answer.hits[0].distance_m - 8) < 1e-9;
        const char* const how = is_right ? "right" : answer.verdict == Verdict::undecided ? "undecided" : "wrong";
        say("%s %llu %lld %s\n", kAnswerLine, answers->epoch, asked, how);
      } else {
        say("%s %lld\n", kRefusedLine, asked);
      }
      std::this_thread::sleep_for(10ms);
    }
  }

  void look(const std::string& path) {
    while (!is_over.load()) {
      const Result<Fleet> seen = fleet(where_);
      {
        std::ofstream out(path + ".new");
        out << now_ns() << ' ' << (seen ? seen->findings.size() : 1) << '\n';
        for (const FleetMember& one : seen ? seen->members : std::vector<FleetMember>{})
          out << one.name << ' ' << name_of(one.role) << ' ' << one.state << ' ' << (one.hash_time != 0s) << '\n';
      }
      std::filesystem::rename(path + ".new", path);
    }
  }

 private:
  template <class... Values>
  void say(const char* format, const Values&... values) {
    const std::lock_guard lock(output_mutex_);
    std::printf(format, values...);
    std::fflush(stdout);
  }

  const ConnectOptions where_;
  Client client_;
  Publisher publisher_;
  Watch watch_;
  std::vector<Vec3> places_;
  std::vector<Publisher::Object> balls_;
  std::mutex output_mutex_;
};

}  // namespace

int run_cut_witness(int domain, const std::string& interface, const std::string& name, const std::string& fleet_path) {
  std::signal(SIGTERM, end);
  CutWitness witness(domain, interface, name);
  std::vector<std::thread> threads;
  threads.emplace_back([&] { witness.move(); });
  threads.emplace_back([&] { witness.listen(); });
  threads.emplace_back([&] { witness.ask(); });
  threads.emplace_back([&] { witness.look(fleet_path); });
  for (std::thread& thread : threads) thread.join();
  return 0;
}

}  // namespace collided::testing_support
