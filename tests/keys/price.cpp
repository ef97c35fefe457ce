// What keys cost: joining, a question's way there and back, and poses a second, for each kind of protection beside a
// server without keys. All in turns in one run, so that what disturbs the machine disturbs all.
// usage: price COLLIDED DOMAIN ROUNDS     exit 1 where joining with keys takes 500 ms or more (the median of several rounds, the
// quickest of a single one)
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "collided/client.hpp"
#include "tests/keys/key_folders.hpp"
#include "tests/service/child_process.hpp"

namespace {

using namespace collided;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using keys::KeyRole;

constexpr int kQuestions = 500;
constexpr int kBatches = 400;
constexpr std::uint32_t kObjects = 1'000;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

template <class T>
T taken(Result<T> result) {
  if constexpr (std::is_void_v<T>) {
    if (!result) throw std::runtime_error(result.error().message);
  } else {
    if (!result) throw std::runtime_error(result.error().message);
    return std::move(*result);
  }
}

const RayQuestion kDown{.origin = {0, 0, 5}, .direction = {0, 0, -1}};

/// One kind of protection: a server with it, and what was measured.
struct Level {
  Level(const char* level_name, std::optional<keys::Protection> protection, const std::string& collided, int on_domain,
        const std::string& scratch)
      : name(level_name), domain(on_domain) {
    std::vector<std::string> words{collided, "--domain", std::to_string(domain), "--state-dir", scratch + '/' + name};
    if (protection) {
      folders = std::make_unique<test::KeyFolders>(*protection);
      words.insert(words.end(), {"--keys", folders->of("brain", {KeyRole::server})});
      own_keys = folders->of("boss", {KeyRole::admin});
    }
    server = std::make_unique<testing_support::ChildProcess>(words, scratch, name);
    if (!server->says("ready:", 20s)) throw std::runtime_error(name + (": " + server->errors()));
  }

  Client join() {
    const auto start = Clock::now();
    Client client = taken(Client::connect({.domain = domain, .wait = 10s, .keys = own_keys}));
    taken(client.ask(kDown));
    join_ms.push_back(seconds_since(start) * 1e3);
    return client;
  }

  void measure() {
    constexpr int kJoinsBefore = 2;
    for (int i = 0; i < kJoinsBefore; ++i) join();
    Client client = join();
    for (int i = 0; i < kQuestions; ++i) {
      const auto asked = Clock::now();
      taken(client.ask(kDown));
      round_trip_us.push_back(seconds_since(asked) * 1e6);
    }
    publish(client);
  }

  void publish(Client& client) {
    Publisher publisher = taken(client.publish("price"));
    for (std::uint32_t i = 0; i < kObjects; ++i) {
      taken(publisher.add({.name = "ball" + std::to_string(i),
                           .shape = {SphereShape{.radius_m = 0.01}},
                           .pose = {.position = {100.0 + i, 0, 0}},
                           .mask = 0}));
    }
    taken(publisher.flush());
    taken(publisher.wait_applied(20s));
    const auto start = Clock::now();
    for (int batch = 0; batch < kBatches; ++batch) {
      for (std::uint32_t i = 0; i < kObjects; ++i)
        static_cast<void>(publisher.move(i, {.position = {100.0 + i, batch * 1e-6, 0}}));
      taken(publisher.flush());
    }
    taken(publisher.wait_applied(20s));
    poses_per_s.push_back(kBatches * kObjects / seconds_since(start));
  }

  const char* name;
  int domain;
  std::unique_ptr<test::KeyFolders> folders;
  std::string own_keys;
  std::unique_ptr<testing_support::ChildProcess> server;
  std::vector<double> join_ms;
  std::vector<double> round_trip_us;
  std::vector<double> poses_per_s;
};

int measure(const std::string& collided, int domain, int rounds) {
  const testing_support::ScratchFolder scratch;
  std::vector<std::unique_ptr<Level>> levels;
  const auto add = [&](const char* name, std::optional<keys::Protection> protection) {
    levels.push_back(
        std::make_unique<Level>(name, protection, collided, domain + static_cast<int>(levels.size()), scratch.path()));
  };
  add("no keys", std::nullopt);
  add("none", keys::Protection::none);
  add("sign", keys::Protection::sign);
  add("encrypt", keys::Protection::encrypt);
  for (int round = 0; round < rounds; ++round) {
    for (const auto& level : levels) level->measure();
  }
  std::printf("%-8s  %9s  %16s  %15s\n", "", "join", "round trip", "poses");
  bool is_slow = false;
  for (const auto& level : levels) {
    const double join_ms = median(level->join_ms);
    std::printf("%-8s  %6.0f ms  %7.1f us %4.2fx  %6.2f M/s %4.2fx\n", level->name, join_ms,
                median(level->round_trip_us), median(level->round_trip_us) / median(levels[0]->round_trip_us),
                median(level->poses_per_s) / 1e6, median(level->poses_per_s) / median(levels[0]->poses_per_s));
    // Other programs make it slower and never faster; in one round all of it may fall into a slow moment.
    is_slow = is_slow || (rounds > 1 ? join_ms : std::ranges::min(level->join_ms)) >= 500;
  }
  return is_slow ? 1 : 0;
}

}  // namespace

int main(int count, char** words) {
  if (count != 4) return std::fprintf(stderr, "usage: price COLLIDED DOMAIN ROUNDS\n"), 2;
  try {
    return measure(words[1], std::atoi(words[2]), std::atoi(words[3]));
  } catch (const std::exception& failed) { return std::fprintf(stderr, "error: %s\n", failed.what()), 2; }
}
