// Two publishers pose a crowd at rates and phases of their own, and some of the one's balls run into the other's:
//   began_latency SERVER SECONDS MOVERS HERTZ
// A contact is shown by the first flush of either that is known up to it; how long after the later of the two its `began`
// reaches a subscriber is what is measured. Prints a line; exits 1 where the 99th percentile is above 20 ms, 2 where too few
// contacts came to say so. The server is told to use half a core at most by who runs this (cpulimit, a cgroup); its use is printed.

#include <atomic>
#include <deque>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <unistd.h>

#include "tests/service/child_process.hpp"
#include "tests/service/endurance/measuring.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr double kMost_ms = 20;
constexpr int kMarkers = 40;  // of each publisher; marker k of the one runs into marker k of the other
constexpr double kLane_m = 10;
constexpr std::size_t kFewest = 100;

nanoseconds now() {
  return std::chrono::duration_cast<nanoseconds>(std::chrono::system_clock::now().time_since_epoch());
}

/// Processor time of a process so far.
double used_s(int pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string word;
  long ticks = 0;
  for (int i = 1; i <= 15 && stat >> word; ++i) {
    if (i >= 14) ticks += std::stol(word);
  }
  return static_cast<double>(ticks) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

struct Flush {
  nanoseconds stamp;
  SteadyClock::time_point sent;
};

/// Half of the crowd: its own thread, rate and phase.
class Half {
 public:
  Half(int domain, const std::string& name, int movers, double hertz, nanoseconds phase)
      : client_(value_of(Client::connect({.domain = domain, .wait = 20s}), "connect")),
        publisher_(value_of(client_.publish(name), "publish")),
        name_(name),
        hertz_(hertz),
        phase_(phase) {
    for (int i = 0; i < movers; ++i) {
      objects_.push_back(value_of(
          publisher_.add(
              {.name = name + "/" + std::to_string(i), .shape = {SphereShape{.radius_m = 0.1}}, .pose = pose(i, 0)}),
          "add"));
    }
  }
  void run(const std::atomic<bool>& stop) {
    const auto period = std::chrono::duration_cast<nanoseconds>(std::chrono::duration<double>(1 / hertz_));
    auto next = SteadyClock::now() + phase_;
    for (int tick = 1; !stop; ++tick, next += period) {
      std::this_thread::sleep_until(next);
      for (std::size_t i = 0; i < objects_.size(); ++i) {
        static_cast<void>(publisher_.move(objects_[i], pose(static_cast<int>(i), tick)));
      }
      const Flush flush{now(), SteadyClock::now()};
      if (publisher_.flush(flush.stamp)) note(flush);
    }
  }
  /// When the first flush was sent that says where everything was at that time; nothing where none has.
  std::optional<SteadyClock::time_point> showed(nanoseconds time) const {
    const std::lock_guard lock(mutex_);
    for (const Flush& flush : flushes_) {
      if (flush.stamp >= time) return flush.sent;
    }
    return std::nullopt;
  }

 private:
  /// Markers of the one stand in lanes; those of the other go to and fro in them, each at a beat of its own.
  Pose pose(int i, int tick) const {
    const bool goes = name_ == "goes";
    if (i < kMarkers) {
      const double away_m = goes ? 0.15 + 0.5 * ((tick + i) % (20 + i % 7)) / 20 : 0;
      return {.position = {i * kLane_m, away_m, 100}};
    }
    return {.position = {(i % 100) * 1.0, (i / 100) * 1.0 + 0.001 * (tick % 50), goes ? 300.0 : 200.0}};
  }
  void note(const Flush& flush) {
    const std::lock_guard lock(mutex_);
    flushes_.push_back(flush);
    if (flushes_.size() > 2'000) flushes_.pop_front();
  }

  Client client_;
  Publisher publisher_;
  std::string name_;
  double hertz_;
  nanoseconds phase_;
  std::vector<Publisher::Object> objects_;
  mutable std::mutex mutex_;
  std::deque<Flush> flushes_;
};

struct Began {
  nanoseconds happened;
  SteadyClock::time_point heard;
};

int run(const std::string& server_path, std::chrono::seconds time, int movers, double hertz) {
  const ScratchFolder folder;
  ChildProcess server({server_path, "--domain", std::to_string(own_domain()), "--state-dir", folder.path()},
                      folder.path(), "server");
  if (!server.says("ready:", 20s)) return 2;
  std::mutex mutex;
  std::vector<Began> began;
  Client client = value_of(Client::connect({.domain = own_domain(), .wait = 10s}), "connect");
  Watch watch = value_of(client.watch({},
                                      [&](const Event& event) {
                                        const std::lock_guard lock(mutex);
                                        if (event.kind == EventKind::began && !event.resync)
                                          began.push_back({happened(event), SteadyClock::now()});
                                      }),
                         "watch");
  Half stands(own_domain(), "stands", movers / 2, hertz, 0ns);
  Half goes(own_domain(), "goes", movers / 2, hertz * 1.07, 3ms);
  std::atomic<bool> stop = false;
  std::jthread one([&] { stands.run(stop); });
  std::jthread other([&] { goes.run(stop); });
  std::this_thread::sleep_for(2s);
  {
    const std::lock_guard lock(mutex);
    began.clear();
  }
  const double used_before_s = used_s(server.pid());
  const auto start = SteadyClock::now();
  std::this_thread::sleep_for(time);
  const double cores = (used_s(server.pid()) - used_before_s) / (ms_since(start) * 1e-3);
  stop = true;
  one.join();
  other.join();
  std::vector<double> lags_ms;
  const std::lock_guard lock(mutex);
  for (const Began& contact : began) {
    const auto shown = std::pair(stands.showed(contact.happened), goes.showed(contact.happened));
    if (!shown.first || !shown.second) continue;
    lags_ms.push_back(
        std::chrono::duration<double, std::milli>(contact.heard - std::max(*shown.first, *shown.second)).count());
  }
  std::printf("movers=%d hertz=%.0f cores=%.2f began=%zu p50=%.2f p99=%.2f worst=%.2f ms\n", movers, hertz, cores,
              lags_ms.size(), percentile(lags_ms, 0.5), percentile(lags_ms, 0.99), percentile(lags_ms, 1));
  if (lags_ms.size() < kFewest) return 2;
  return percentile(lags_ms, 0.99) <= kMost_ms ? 0 : 1;
}

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  using namespace collided::testing_support;
  if (argc != 5) {
    std::fprintf(stderr, "usage: began_latency SERVER SECONDS MOVERS HERTZ\n");
    return 2;
  }
  return run(argv[1], std::chrono::seconds(std::atoi(argv[2])), std::atoi(argv[3]), std::atof(argv[4]));
}
