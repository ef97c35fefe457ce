// Round trips of the client library against a server of another process that answers at once in its callback, so that
// what is measured is the wire and the library. Beside it: `ddsperf ping` and `ddsperf pong` in the same minute.
//   wire_round_trip [count]
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "collided/client.hpp"
#include "tests/service/wire/fake_server.hpp"

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

[[noreturn]] void serve(const std::string& name_space, int domain) {
  const collided::test::FakeServer server(name_space, 1, {.domain = domain, .role = collided::dds::Role::server});
  while (true) { pause(); }
}

void report(const char* what, std::vector<double>& times_us) {
  std::sort(times_us.begin(), times_us.end());
  const auto at = [&](double fraction) {
    return times_us[static_cast<std::size_t>(fraction * static_cast<double>(times_us.size() - 1))];
  };
  std::printf("%-28s %7zu asked   p50 %8.1f us   p99 %8.1f us   worst %8.1f us   mean %8.1f us\n", what,
              times_us.size(), at(0.5), at(0.99), times_us.back(),
              std::accumulate(times_us.begin(), times_us.end(), 0.0) / static_cast<double>(times_us.size()));
}

template <class Ask>
bool measure(const char* what, int count, const Ask& ask) {
  std::vector<double> times_us;
  for (int i = 0; i < count; ++i) {
    const auto start = Clock::now();
    if (!ask(i)) { return false; }
    times_us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
  report(what, times_us);
  return true;
}

bool run(const std::string& name_space, int domain, int count) {
  collided::Result<collided::Client> client =
      collided::Client::connect({.domain = domain, .name_space = name_space, .wait = 5s});
  if (!client) {
    std::fprintf(stderr, "%s\n", client.error().message.c_str());
    return false;
  }
  const auto ray = [](int i) { return collided::RayQuestion{{static_cast<double>(i), 0, 5}, {0, 0, -1}}; };
  std::vector<collided::RayQuestion> thousand;
  std::vector<collided::RayQuestion> many;
  for (int i = 0; i < 100'000; ++i) { many.push_back(ray(i)); }
  thousand.assign(many.begin(), many.begin() + 1'000);
  const collided::AskOptions patient{.timeout = 10s};
  return measure("warm-up", 2'000, [&](int i) { return bool(client->ask(ray(i))); }) &&
         measure("one ray, hit", count, [&](int i) { return bool(client->ask(ray(i))); }) &&
         measure("one ray, miss", count, [&](int) { return bool(client->ask(ray(-1))); }) &&
         measure("1,000 rays", count / 50, [&](int) { return bool(client->ask(thousand, patient)); }) &&
         measure("100,000 rays", 20, [&](int) { return bool(client->ask(many, patient)); });
}

}  // namespace

int main(int argument_count, char** arguments) {
  const int count = argument_count > 1 ? std::atoi(arguments[1]) : 20'000;
  const int domain = collided::test::own_domain();
  const std::string name_space = collided::test::own_namespace();
  const pid_t server = fork();  // before either side has threads
  if (server == 0) { serve(name_space, domain); }
  const bool good = run(name_space, domain, count);
  kill(server, SIGTERM);
  waitpid(server, nullptr, 0);
  return good ? 0 : 1;
}
