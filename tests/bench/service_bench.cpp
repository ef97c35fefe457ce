// What the service costs beside its transport: round trips of single rays, and the share of a core that moving objects
// take. Talks to a running server.
// usage: service_bench rtt COUNT | service_bench movers COUNT HZ SECONDS SERVER_PID   [--domain N] [--namespace NAME]
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <collided/client.hpp>

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

template <class T>
T must(collided::Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "service_bench: %s\n", result.error().message.c_str());
    std::exit(1);
  }
  return std::move(*result);
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
  const auto at = [&](double share) { return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))]; };
  std::printf("rtt rays=%d p50_us=%.1f p90_us=%.1f p99_us=%.1f max_us=%.1f in_server_p50_us=%.1f\n", count, at(0.5), at(0.9), at(0.99), at(1),
              in_server[in_server.size() / 2]);
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
      poses[static_cast<std::size_t>(i)].position += 0.01 * Vec3(uniform(random), uniform(random), uniform(random)) / 50;
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
  std::printf("movers count=%d hz=%.0f frames=%llu late_frames=%llu core_share=%.3f events=%llu lost=%llu "
              "poses_dropped=%llu open_contacts=%u\n",
              count, hz, static_cast<unsigned long long>(frames), static_cast<unsigned long long>(late), cpu / wall,
              static_cast<unsigned long long>(events), static_cast<unsigned long long>(watch.lost()),
              static_cast<unsigned long long>(status.poses_dropped), status.contacts);
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
  if (plain.size() < 2) {
    std::fprintf(stderr, "usage: service_bench rtt COUNT | movers COUNT HZ SECONDS SERVER_PID  [--domain N]\n");
    return 2;
  }
  collided::Client client = must(collided::Client::connect(connect));
  if (plain[0] == "rtt") return round_trips(client, std::atoi(plain[1].c_str()));
  if (plain[0] == "movers" && plain.size() == 5) {
    return movers(client, std::atoi(plain[1].c_str()), std::atof(plain[2].c_str()), std::atof(plain[3].c_str()),
                  std::atoi(plain[4].c_str()));
  }
  return 2;
}
