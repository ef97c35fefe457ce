// How often a server that lives is taken for dead while the machine has too much to do:
//   false_alarms SERVER SECONDS BUSY
// BUSY endless loops a core run beside the server, three subscribers and a publisher that goes on moving. Counts the times
// that the last word of the server was older than three limits, 300 ms (three periods at 10 Hz) and 150 ms (three periods
// at 20 Hz) beside the library's own. Prints one line and exits 1 where the library said "disconnected".

#include <sys/prctl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "collided/client.hpp"
#include "idl/topics.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/endurance/measuring.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;

constexpr int kBalls = 200;
constexpr std::array<double, 3> kLimits_ms{150, 1e-6 * wire_contract::kStatusLostNs, 300};

/// Endless loops in processes of their own; they end with the object, or with this process.
class Busy {
 public:
  explicit Busy(unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      const pid_t child = fork();
      if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        for (std::atomic<std::uint64_t> turns{0};;) turns.fetch_add(1, std::memory_order_relaxed);
      }
      loops_.push_back(child);
    }
  }
  ~Busy() {
    for (const pid_t loop : loops_) kill(loop, SIGKILL);
  }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  std::vector<pid_t> loops_;
};

/// Who looks how long ago a server has been heard of.
class Looker {
 public:
  explicit Looker(int domain) : client_(value_of(Client::connect({.domain = domain, .wait = 20s}), "connect")) {
    watch_.emplace(value_of(client_.watch(), "watch"));
  }
  void look() {
    while (watch_->next(0ns)) {}
    const double age_ms = std::chrono::duration<double, std::milli>(value_of(client_.status(), "status").age).count();
    worst_ms_ = std::max(worst_ms_, age_ms);
    for (std::size_t i = 0; i < kLimits_ms.size(); ++i) {
      const bool is_late = age_ms > kLimits_ms[i];
      alarms_[i] += is_late && !late_[i] ? 1 : 0;
      late_[i] = is_late;
    }
    const bool is_lost = !watch_->connected();
    disconnected_ += is_lost && !lost_ ? 1 : 0;
    lost_ = is_lost;
  }
  int alarms(std::size_t limit) const { return alarms_[limit]; }
  int disconnected() const { return disconnected_; }
  double worst_ms() const { return worst_ms_; }
  Client& client() { return client_; }

 private:
  Client client_;
  std::optional<Watch> watch_;
  std::array<bool, kLimits_ms.size()> late_{};
  std::array<int, kLimits_ms.size()> alarms_{};
  int disconnected_ = 0;
  bool lost_ = false;
  double worst_ms_ = 0;
};

int run(const std::string& server, int seconds, unsigned busy_a_core) {
  const ScratchFolder folder;
  const int domain = own_domain();
  ChildProcess process({server, "--domain", std::to_string(domain), "--state-dir", folder.path()}, folder.path(),
                       "server");
  std::vector<std::unique_ptr<Looker>> query_movers;
  for (int i = 0; i < 3; ++i) query_movers.push_back(std::make_unique<Looker>(domain));
  Publisher publisher = value_of(query_movers[0]->client().publish("mover"), "publish");
  std::vector<Publisher::Object> balls;
  for (int i = 0; i < kBalls; ++i) {
    balls.push_back(value_of(publisher.add({.name = "ball " + std::to_string(i),
                                            .shape = {SphereShape{.radius_m = 0.3}},
                                            .pose = {.position = {100.0 + i, 0, 0}}}),
                             "add"));
  }
  std::this_thread::sleep_for(1s);
  const Busy busy(busy_a_core * std::max(1U, std::thread::hardware_concurrency()));
  const auto started = SteadyClock::now();
  for (int round = 0; ms_since(started) < 1e3 * seconds; ++round) {
    for (std::size_t i = 0; i < balls.size(); ++i) {
      static_cast<void>(
          publisher.move(balls[i], {.position = {100.0 + static_cast<double>(i), 0.01 * (round % 100), 0}}));
    }
    static_cast<void>(publisher.flush());
    for (int look = 0; look < 5; ++look) {
      for (const auto& looker : query_movers) looker->look();
      std::this_thread::sleep_for(2ms);
    }
  }
  std::array<int, kLimits_ms.size()> alarms{};
  int disconnected = 0;
  double worst_ms = 0;
  for (const auto& looker : query_movers) {
    for (std::size_t i = 0; i < alarms.size(); ++i) alarms[i] += looker->alarms(i);
    disconnected += looker->disconnected();
    worst_ms = std::max(worst_ms, looker->worst_ms());
  }
  std::printf("seconds=%d busy_a_core=%u", seconds, busy_a_core);
  for (std::size_t i = 0; i < alarms.size(); ++i) std::printf(" over_%.0f_ms=%d", kLimits_ms[i], alarms[i]);
  std::printf(" longest_ms=%.0f disconnected=%d\n", worst_ms, disconnected);
  return disconnected == 0 ? 0 : 1;
}

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: false_alarms SERVER SECONDS BUSY\n");
    return 2;
  }
  return collided::testing_support::run(argv[1], std::atoi(argv[2]), static_cast<unsigned>(std::atoi(argv[3])));
}
