// What it costs to ask four shards and how late their events come, beside one server that holds everything:
//   shard_latency SERVER ROUNDS [SEED]
// The servers have the embedded scene, and nothing moves. In each round the same rays go to the one server and to the shards
// in turn, one by one and in batches of a thousand: rays that one shard answers, and rays across borders. Prints medians and
// 99th percentiles of both. Then two balls begin and end a contact with each flush of a publisher of 50 Hz, first in one of
// the shards and then across a border; the delay of an event counts from that flush to its arrival at a watch.
// Exits 1 if an answer of the shards differs from that of the one server, or an event does not come.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "collided/shards.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/endurance/measuring.hpp"
#include "tests/shards/same_answers.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;

constexpr const char* kQuarters = R"({"margin_m": 0.5, "shards": [
  {"name": "a", "low": [null, null, null], "high": [0, 0, null]},
  {"name": "b", "low": [0, null, null], "high": [null, 0, null]},
  {"name": "c", "low": [null, 0, null], "high": [0, null, null]},
  {"name": "d", "low": [0, 0, null], "high": [null, null, null]}]})";

constexpr std::size_t kBatch = 1'000;

/// Down at the floor, away from all borders: one shard answers.
RayQuestion ray_down(std::mt19937_64& random) {
  std::uniform_real_distribution<double> away(1, 7);
  const auto side = [&] { return random() % 2 == 0 ? -away(random) : away(random); };
  return {.origin = {side(), side(), 6}, .direction = {0, 0, -1}, .length_m = 100};
}

/// From one corner of the hall to the one across: three shards are touched, or four.
RayQuestion ray_across(std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(2, 7);
  std::uniform_real_distribution<double> height(0.1, 4);
  const Vec3 from(-place(random), -place(random), height(random));
  const Vec3 to(place(random), place(random), height(random));
  return {.origin = from, .direction = to - from, .length_m = 100};
}

class ShardLatency {
 public:
  ShardLatency(std::string server, std::uint64_t seed) : server_(std::move(server)), random_(seed) {
    const std::string map = folder_.write("map.json", kQuarters);
    start("whole", {"--namespace", "whole"});
    for (const char* shard : {"a", "b", "c", "d"}) start(shard, {"--namespace", "city", "--shard", map + ':' + shard});
    whole_.emplace(value_of(Client::connect({.domain = domain_, .name_space = "whole", .wait = 20s}), "connect"));
    shards_.emplace(
        value_of(ShardedClient::connect(map, {.domain = domain_, .name_space = "city", .wait = 20s}), "connect"));
  }

  /// Returns the number of answers that differ.
  int run(int rounds) {
    for (int round = -kWarmUp; round < rounds; ++round) {
      const bool counts = round >= 0;
      ask("a ray, one shard", {ray_down(random_)}, counts);
      ask("a ray, across borders", {ray_across(random_)}, counts);
      if (round % kRoundsToABatch != 0) continue;
      std::vector<RayQuestion> down, across;
      for (std::size_t i = 0; i < kBatch; ++i) {
        down.push_back(ray_down(random_));
        across.push_back(ray_across(random_));
      }
      ask("1,000 rays, one shard each", down, counts);
      ask("1,000 rays, across borders", across, counts);
    }
    std::printf("%-28s %21s %21s %7s\n", "", "one server, us", "four shards, us", "ratio");
    std::printf("%-28s %10s %10s %10s %10s %7s\n", "", "p50", "p99", "p50", "p99", "p50");
    for (const auto& [name, times] : times_) print(name, times);
    std::printf("%d answers differ\n", differing_);
    times_.clear();
    Publisher of_whole = value_of(whole_->publish("balls"), "publish");
    Watch whole_watch = value_of(whole_->watch(), "watch");
    time_events("an event, one shard", {-4, -4, 50}, of_whole, whole_watch, rounds, &Times::whole_us);
    time_events("an event, at a border", {0, -4, 50}, of_whole, whole_watch, rounds, &Times::whole_us);
    ShardedPublisher of_shards = value_of(shards_->publish("balls"), "publish");
    ShardedWatch shards_watch = value_of(shards_->watch(), "watch");
    time_events("an event, one shard", {-4, -4, 50}, of_shards, shards_watch, rounds, &Times::shards_us);
    time_events("an event, at a border", {0, -4, 50}, of_shards, shards_watch, rounds, &Times::shards_us);
    for (const auto& [name, times] : times_) print(name, times);
    return differing_ + missing_;
  }

 private:
  static constexpr int kWarmUp = 50;
  static constexpr int kRoundsToABatch = 10;
  static constexpr auto kFlush = 20ms;
  struct Times {
    std::vector<double> whole_us;
    std::vector<double> shards_us;
  };

  void start(const std::string& name, std::vector<std::string> words) {
    words.insert(words.begin(),
                 {server_, "--domain", std::to_string(domain_), "--state-dir", folder_.path(), "--member", name});
    servers_.push_back(std::make_unique<ChildProcess>(words, folder_.path(), name));
    if (servers_.back()->says("ready:", 60s)) return;
    std::fprintf(stderr, "%s does not start: %s\n", name.c_str(), servers_.back()->errors().c_str());
    std::exit(2);
  }

  template <class Asked>
  static Answers timed(Asked& asked, const std::vector<RayQuestion>& rays, double& time_us) {
    const SteadyClock::time_point began = SteadyClock::now();
    Answers answers = value_of(asked.ask(rays), "ask");
    time_us = 1'000 * ms_since(began);
    return answers;
  }

  void ask(const std::string& name, const std::vector<RayQuestion>& rays, bool counts) {
    double whole_us = 0;
    double shards_us = 0;
    // Neither is always the one that finds the caches warm.
    const bool is_whole_first = random_() % 2 == 0;
    Answers of_shards;
    if (!is_whole_first) of_shards = timed(*shards_, rays, shards_us);
    const Answers of_whole = timed(*whole_, rays, whole_us);
    if (is_whole_first) of_shards = timed(*shards_, rays, shards_us);
    for (std::size_t i = 0; i < rays.size(); ++i)
      differing_ += are_equal(of_whole.answers[i], of_shards.answers[i]) ? 0 : 1;
    if (!counts) return;
    times_[name].whole_us.push_back(whole_us);
    times_[name].shards_us.push_back(shards_us);
  }

  /// Two balls touch after every other flush.
  template <class AnyPublisher, class AnyWatch>
  void time_events(const std::string& name, const Vec3& at, AnyPublisher& publisher, AnyWatch& watch, int rounds,
                   std::vector<double> Times::*times) {
    const Shape ball{SphereShape{.radius_m = 0.1}};
    const Vec3 apart(0, 0.3, 0);
    const auto rests = value_of(publisher.add({.name = "rests", .shape = ball, .pose = {.position = at}}), "add");
    const auto goes = value_of(publisher.add({.name = "goes", .shape = ball, .pose = {.position = at + apart}}), "add");
    // Until what is decided follows the publisher's instants.
    for (int flush = 0; flush < 50; ++flush, std::this_thread::sleep_for(kFlush)) value_of(publisher.flush(), "flush");
    for (int round = 0; round < 2 * rounds; ++round) {
      const bool touches = round % 2 == 0;
      value_of(publisher.move(goes, {.position = touches ? at : Vec3(at + apart)}), "move");
      const SteadyClock::time_point flushed = SteadyClock::now();
      value_of(publisher.flush(), "flush");
      std::optional<Event> event;
      // The publisher goes on, since the time of its shards does not pass without it.
      do {
        const auto next_flush = SteadyClock::now() + kFlush;
        event = watch.next(kFlush);
        if (event) (times_[name].*times).push_back(1'000 * ms_since(flushed));
        std::this_thread::sleep_until(next_flush);
        value_of(publisher.flush(), "flush");
      } while (!event && SteadyClock::now() < flushed + 2s);
      if (event && event->kind == (touches ? EventKind::began : EventKind::ended)) continue;
      std::printf("%s, round %d: %s\n", name.c_str(), round, event ? "another event came" : "no event came");
      ++missing_;
    }
    value_of(publisher.remove(goes), "remove");
    value_of(publisher.remove(rests), "remove");
    value_of(publisher.flush(), "flush");
  }

  static void print(const std::string& name, const Times& times) {
    const double whole_p50 = percentile(times.whole_us, 0.5);
    const double shards_p50 = percentile(times.shards_us, 0.5);
    std::printf("%-28s %10.0f %10.0f %10.0f %10.0f %7.2f\n", name.c_str(), whole_p50, percentile(times.whole_us, 0.99),
                shards_p50, percentile(times.shards_us, 0.99), shards_p50 / whole_p50);
  }

  const std::string server_;
  std::mt19937_64 random_;
  const int domain_ = own_domain();
  ScratchFolder folder_;
  std::vector<std::unique_ptr<ChildProcess>> servers_;
  std::optional<Client> whole_;
  std::optional<ShardedClient> shards_;
  std::map<std::string, Times> times_;
  int differing_ = 0;
  int missing_ = 0;
};

}  // namespace
}  // namespace collided::testing_support

int main(int count, char** words) {
  if (count < 3) {
    std::fprintf(stderr, "usage: shard_latency SERVER ROUNDS [SEED]\n");
    return 2;
  }
  const std::uint64_t seed = count > 3 ? std::strtoull(words[3], nullptr, 10) : 28;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  collided::testing_support::ShardLatency latency(words[1], seed);
  return latency.run(std::atoi(words[2])) == 0 ? 0 : 1;
}
