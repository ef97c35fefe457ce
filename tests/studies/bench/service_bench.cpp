// What the service costs beside its transport: round trips of single rays, and the share of a core that moving objects
// take. Talks to a running server.
// usage: service_bench rtt COUNT | movers COUNT HZ SECONDS SERVER_PID | steps   [--domain N] [--namespace NAME]
// steps does what its input asks for, line by line, and says how long each took, for a program that compares:
//   single COUNT              single rays, one after the other
//   batches SIZE COUNT ASKERS batches of rays, one after the other in each of so many threads
//   flood SIZE COUNT          single rays while another client has a batch of that size under way all the time
//   poses FLUSHES EACH        poses of a thousand balls, so many a flush, until the server has applied them all
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include <collided/client.hpp>

#include "tests/studies/bench/service_rays.hpp"

namespace {

using Clock = std::chrono::steady_clock;
using collided::Vec3;

double microseconds(Clock::duration d) { return std::chrono::duration<double, std::micro>(d).count(); }

/// Seconds of processor time that a process has used.
double cpu_seconds(int pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string text((std::istreambuf_iterator<char>(stat)), {});
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0;
  double system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double at(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

template <class T>
T must(collided::Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "service_bench: %s\n", result.error().message.c_str());
    std::exit(1);
  }
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

int round_trips(collided::Client& client, int count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> times;
  std::vector<double> in_server;  // from taking the question to writing the answer
  for (int i = 0; i < count + 1'000; ++i) {
    const collided::RayQuestion ray{.origin = {5 * uniform(random), 5 * uniform(random), 4},
                                    .direction = {0.2 * uniform(random), 0.2 * uniform(random), -1}};
    const auto started = Clock::now();
    const auto answers = must(client.ask(std::span(&ray, 1)));
    if (i < 1'000) continue;
    times.push_back(microseconds(Clock::now() - started));
    in_server.push_back(microseconds(answers.compute));
  }
  std::sort(times.begin(), times.end());
  std::sort(in_server.begin(), in_server.end());
  std::printf("rtt rays=%d p50_us=%.1f p90_us=%.1f p99_us=%.1f max_us=%.1f in_server_p50_us=%.1f\n", count,
              at(times, 0.5), at(times, 0.9), at(times, 0.99), at(times, 1), at(in_server, 0.5));
  return 0;
}

int movers(collided::Client& client, int count, double hz, double seconds, int pid) {
  collided::Publisher publisher = must(client.publish("bench"));
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-50, 50);
  std::vector<collided::Publisher::Object> objects;
  std::vector<collided::Pose> poses;
  for (int i = 0; i < count; ++i) {
    collided::ObjectOptions options;
    options.name = "bench/" + std::to_string(i);
    options.shape = {collided::SphereShape{.radius_m = 0.5}};
    options.pose.position = {uniform(random), uniform(random), uniform(random)};
    poses.push_back(options.pose);
    objects.push_back(must(publisher.add(options)));
  }
  must(publisher.wait_applied(std::chrono::seconds(20)));
  auto watch = must(client.watch());
  const double cpu_before = cpu_seconds(pid);
  const auto started = Clock::now();
  auto tick = started;
  const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / hz));
  std::uint64_t frames = 0;
  std::uint64_t late = 0;
  for (; tick - started < std::chrono::duration<double>(seconds); tick += period, ++frames) {
    std::this_thread::sleep_until(tick);
    if (Clock::now() - tick > period) ++late;
    for (int i = 0; i < count; ++i) {
      poses[static_cast<std::size_t>(i)].position +=
          0.01 * Vec3(uniform(random), uniform(random), uniform(random)) / 50;
      must(publisher.move(objects[static_cast<std::size_t>(i)], poses[static_cast<std::size_t>(i)]));
      if (i % 1'000 == 999) must(publisher.flush());
    }
    must(publisher.flush());
  }
  must(publisher.wait_applied(std::chrono::seconds(20)));
  const double wall = std::chrono::duration<double>(Clock::now() - started).count();
  const double cpu = cpu_seconds(pid) - cpu_before;
  const auto status = must(client.status());
  std::uint64_t events = 0;
  while (watch.next(std::chrono::milliseconds(50))) ++events;
  std::printf(
      "movers count=%d hz=%.0f frames=%llu late_frames=%llu core_share=%.3f events=%llu lost=%llu "
      "poses_dropped=%llu open_contacts=%u\n",
      count, hz, static_cast<unsigned long long>(frames), static_cast<unsigned long long>(late), cpu / wall,
      static_cast<unsigned long long>(events), static_cast<unsigned long long>(watch.lost()),
      static_cast<unsigned long long>(status.poses_dropped), status.contacts);
  return 0;
}

std::vector<collided::RayQuestion> rays(std::size_t count, std::uint64_t seed) {
  const std::vector<double> numbers = service_rays(count, seed);
  std::vector<collided::RayQuestion> made;
  for (std::size_t i = 0; i < numbers.size(); i += 7) {
    made.push_back({.origin = {numbers[i], numbers[i + 1], numbers[i + 2]},
                    .direction = {numbers[i + 3], numbers[i + 4], numbers[i + 5]},
                    .length_m = numbers[i + 6]});
  }
  return made;
}

/// Sorted, in microseconds.
std::vector<double> singles(collided::Client& client, int count) {
  const std::vector<collided::RayQuestion> asked = rays(static_cast<std::size_t>(count), 1);
  std::vector<double> times;
  for (const collided::RayQuestion& ray : asked) {
    const auto started = Clock::now();
    must(client.ask(std::span(&ray, 1)));
    times.push_back(microseconds(Clock::now() - started));
  }
  std::sort(times.begin(), times.end());
  return times;
}

void say_singles(const std::vector<double>& times) {
  std::printf("%.3f %.3f %.3f %.3f\n", at(times, 0.5), at(times, 0.9), at(times, 0.99), at(times, 1));
}

/// Wall time in microseconds.
double batches(collided::Client& client, int size, int count, int askers) {
  std::vector<std::vector<collided::RayQuestion>> asked;
  for (int i = 0; i < askers; ++i) asked.push_back(rays(static_cast<std::size_t>(size), 1 + i));
  std::vector<std::thread> threads;
  const auto started = Clock::now();
  for (int i = 0; i < askers; ++i) {
    threads.emplace_back([&, i] {
      collided::Answers answers;
      for (int round = 0; round < count; ++round) {
        answers = must(client.ask(std::span<const collided::RayQuestion>(asked[static_cast<std::size_t>(i)]),
                                  {.timeout = std::chrono::seconds(60)}, std::move(answers)));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  return microseconds(Clock::now() - started);
}

void flooded(collided::Client& client, const collided::ConnectOptions& connect, int size, int count) {
  collided::Client other = must(collided::Client::connect(connect));
  std::atomic<bool> over{false};
  std::atomic<int> rounds{0};
  std::thread flood([&] {
    while (!over.load()) {
      batches(other, size, 1, 1);
      ++rounds;
    }
  });
  while (rounds.load() == 0) std::this_thread::yield();
  say_singles(singles(client, count));
  over.store(true);
  flood.join();
}

/// Wall times in microseconds: until the last flush returned, and until the server had applied it.
void poses(collided::Client& client, int flushes, int each) {
  constexpr int kBalls = 1'000;
  collided::Publisher publisher = must(client.publish("bench_poses"));
  std::vector<collided::Publisher::Object> balls;
  for (int i = 0; i < kBalls; ++i) {
    collided::ObjectOptions options;
    options.name = "bench_poses/" + std::to_string(i);
    options.shape = {collided::SphereShape{.radius_m = 0.1}};
    options.pose.position = {1.0 * i, 0, 200};
    balls.push_back(must(publisher.add(options)));
  }
  must(publisher.wait_applied(std::chrono::seconds(20)));
  const auto started = Clock::now();
  int moved = 0;
  for (int flush = 0; flush < flushes; ++flush) {
    for (int i = 0; i < each; ++i, ++moved) {
      const int ball = moved % kBalls;
      const double height = 200 + 1e-6 * moved;
      must(publisher.move(balls[static_cast<std::size_t>(ball)], {.position = {1.0 * ball, 0, height}}));
    }
    must(publisher.flush());
  }
  const double flushed = microseconds(Clock::now() - started);
  must(publisher.wait_applied(std::chrono::seconds(60)));
  std::printf("%.3f %.3f\n", flushed, microseconds(Clock::now() - started));
}

int steps(collided::Client& client, const collided::ConnectOptions& connect) {
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream words(line);
    std::string what;
    int first = 0;
    int second = 0;
    int third = 1;
    words >> what >> first >> second >> third;
    if (what == "single") say_singles(singles(client, first));
    if (what == "batches") std::printf("%.3f\n", batches(client, first, second, third));
    if (what == "flood") flooded(client, connect, first, second);
    if (what == "poses") poses(client, first, second);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int count, char** words) {
  collided::ConnectOptions connect;
  std::vector<std::string> plain;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--domain" && i + 1 < count) {
      connect.domain = std::atoi(words[++i]);
    } else if (word == "--namespace" && i + 1 < count) {
      connect.name_space = words[++i];
    } else {
      plain.push_back(word);
    }
  }
  if (plain.empty() || (plain[0] != "steps" && plain.size() < 2)) {
    std::fprintf(stderr, "usage: service_bench rtt COUNT | movers COUNT HZ SECONDS SERVER_PID | steps  [--domain N]\n");
    return 2;
  }
  collided::Client client = must(collided::Client::connect(connect));
  if (plain[0] == "steps") return steps(client, connect);
  if (plain[0] == "rtt") return round_trips(client, std::atoi(plain[1].c_str()));
  if (plain[0] == "movers" && plain.size() == 5) {
    return movers(client, std::atoi(plain[1].c_str()), std::atof(plain[2].c_str()), std::atof(plain[3].c_str()),
                  std::atoi(plain[4].c_str()));
  }
  return 2;
}
