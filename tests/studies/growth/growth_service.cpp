// How a server's time grows with its clients and with those who subscribe to events, over DDS. Lines "law x low median
// high" for growth_study; the law is its number in service_laws().
//   growth_service --server PROGRAM [--quick]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <collided/client.hpp>

#include "tests/service/child_process.hpp"
#include "tests/studies/bench/service_rays.hpp"

namespace {

using namespace collided;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int kRepeats = 5;

template <class T>
T must(Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "growth_service: %s\n", result.error().message.c_str());
    std::exit(1);
  }
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

double microseconds(Clock::duration d) { return std::chrono::duration<double, std::micro>(d).count(); }

/// Microseconds of processor time that a process's threads have used.
double processor_us(int pid) {
  double ns = 0;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
    double own = 0;
    std::ifstream(thread.path() / "schedstat") >> own;
    ns += own;
  }
  return 1e-3 * ns;
}

void say(int law, int x, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::printf("%d %d %.6g %.6g %.6g\n", law, x, values.front(), values[values.size() / 2], values.back());
  std::fflush(stdout);
}

/// So many clients, each with one ray under way all the time.
void measure_clients(const ConnectOptions& connect, int pid, int count, int questions) {
  std::vector<Client> clients;
  for (int i = 0; i < count; ++i) clients.push_back(must(Client::connect(connect)));
  std::vector<double> each_us, server_us;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const double server_before = processor_us(pid);
    const auto started = Clock::now();
    std::vector<std::thread> threads;
    for (int i = 0; i < count; ++i) {
      threads.emplace_back([&, i] {
        const std::vector<double> n = service_rays(static_cast<std::size_t>(questions / count), 1 + i);
        for (std::size_t k = 0; k < n.size(); k += 7) {
          (void)must(clients[static_cast<std::size_t>(i)].ask(RayQuestion{.origin = {n[k], n[k + 1], n[k + 2]},
                                                                          .direction = {n[k + 3], n[k + 4], n[k + 5]},
                                                                          .length_m = n[k + 6]},
                                                              {.timeout = 20s}));
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    const double asked = questions / count * count;
    each_us.push_back(microseconds(Clock::now() - started) / asked);
    server_us.push_back((processor_us(pid) - server_before) / asked);
  }
  say(0, count, each_us);
  say(1, count, server_us);
}

/// Two balls that meet and part; everybody hears of it before they go on.
class Meetings {
 public:
  explicit Meetings(Client& client) : publisher_(must(client.publish("growth"))) {
    (void)must(
        publisher_.add({.name = "rest", .shape = {SphereShape{.radius_m = 1}}, .pose = {.position = {0, 0, kHigh_m}}}));
    ball_ = must(publisher_.add(
        {.name = "ball", .shape = {SphereShape{.radius_m = 1}}, .pose = {.position = {kFar_m, 0, kHigh_m}}}));
    must(publisher_.wait_applied(5s));
  }
  /// False: somebody has not heard of it.
  bool one(std::vector<Watch>& watches) {
    meets_ = !meets_;
    must(publisher_.move(ball_, {.position = {meets_ ? 1.5 : kFar_m, 0, kHigh_m}}));
    (void)must(publisher_.flush());
    return std::all_of(watches.begin(), watches.end(), [&](Watch& watch) {
      const std::optional<Event> event = watch.next(5s);
      return event && event->kind == (meets_ ? EventKind::began : EventKind::ended);
    });
  }

 private:
  static constexpr double kFar_m = 5;
  static constexpr double kHigh_m = 100;  // above the scene that a server without arguments shows

  Publisher publisher_;
  Publisher::Object ball_;
  bool meets_ = false;
};

void measure_subscribers(Client& client, const ConnectOptions& connect, int pid, int count, int meetings) {
  std::vector<Client> clients;
  std::vector<Watch> watches;
  for (int i = 0; i < count; ++i) {
    clients.push_back(must(Client::connect(connect)));
    watches.push_back(must(clients.back().watch()));
  }
  for (Watch& watch : watches) {
    while (!watch.in_step()) std::this_thread::sleep_for(1ms);
  }
  Meetings pair(client);
  std::vector<double> heard_us, server_us;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const double server_before = processor_us(pid);
    const auto started = Clock::now();
    for (int i = 0; i < meetings; ++i) {
      if (!pair.one(watches)) {
        std::fprintf(stderr, "growth_service: one of %d subscribers missed an event\n", count);
        std::exit(1);
      }
    }
    heard_us.push_back(microseconds(Clock::now() - started) / meetings);
    server_us.push_back((processor_us(pid) - server_before) / meetings);
  }
  say(2, count, heard_us);
  say(3, count, server_us);
}

}  // namespace

int main(int argc, char** argv) {
  std::string program;
  bool quick = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--quick") quick = true;
    else if (word == "--server" && i + 1 < argc) program = argv[++i];
  }
  if (program.empty()) {
    std::fprintf(stderr, "usage: growth_service --server PROGRAM [--quick]\n");
    return 2;
  }
  const testing_support::ScratchFolder folder;
  const int domain = testing_support::own_domain();
  testing_support::ChildProcess server(
      {program, "--domain", std::to_string(domain), "--state-dir", folder.path(), "--threads", "1"}, folder.path(),
      "server");
  if (!server.says("ready:", 60s)) {
    std::fprintf(stderr, "growth_service: %s\n", server.errors().c_str());
    return 1;
  }
  const ConnectOptions connect{.domain = domain};
  Client client = must(Client::connect(connect));
  for (int count = 1; count <= (quick ? 16 : 64); count *= 2) {
    measure_clients(connect, server.pid(), count, quick ? 400 : 16'000);
    measure_subscribers(client, connect, server.pid(), count, quick ? 10 : 200);
  }
  return 0;
}
