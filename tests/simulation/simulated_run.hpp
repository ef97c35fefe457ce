#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tests/simulation/seeded_choices.hpp"
#include "tests/simulation/simulated_publisher.hpp"
#include "tests/simulation/simulated_server.hpp"

namespace collided::simulation {
using namespace engine;

/// One seed: publishers that move, add, remove, hang, crash and come back, a server that crashes, a line to it that
/// loses, repeats and reorders poses; then calm, and what must be true by then.
class SimulatedRun : private SeededChoices {
 public:
  SimulatedRun(std::uint64_t seed, std::FILE* to);
  void run();

  std::uint64_t steps() const { return steps_; }
  std::uint64_t violations() const { return violations_; }

 private:
  static constexpr std::int64_t kTickNs = 10'000'000;

  struct Lost {
    std::uint64_t publisher;
  };
  struct Sent {
    std::int64_t time_ns;
    std::variant<service::DefinitionSample, service::PoseSample, Lost> what;
  };
  struct Host {
    SimulatedPublisher publisher;
    std::int64_t period = 1;  // of its flushes, in ticks
    bool is_dead = false;
    std::int64_t sleeps_until_ns = 0;
    bool was_away = false;               // longer than its lease
    std::int64_t definitions_at_ns = 0;  // the last one arrives; those behind it later
    std::uint64_t server_epoch = 0;      // that it has told everything
    std::int64_t notices_at_ns = 0;      // the new server
  };

  void tick(bool is_calm);
  void trouble();
  void trouble(Host& host);
  void live(Host& host, bool is_calm);
  void act(Host& host, bool is_calm);
  void add_object(Host& host);
  std::int64_t any_period() { return chance(0.5) ? 1 : 2 + up_to(18); }
  void crash(Host& host);
  void come_back(Host& host);
  void send(Host& host, service::DefinitionSample sample);
  void send(service::PoseSample sample, bool is_calm);
  void deliver();
  void settle_truth();
  void violation(const std::string& what);

  std::uint64_t seed_;
  std::FILE* to_;
  Payload payload_;
  std::int64_t now_ns_ = 1'000'000'000;
  bool is_still_ = false;  // nothing new is sent
  std::uint64_t epoch_ = 0;
  std::uint64_t next_id_ = 1;
  std::unique_ptr<SimulatedServer> server_;
  std::int64_t server_back_ns_ = 0;
  std::vector<Host> hosts_;
  std::vector<Sent> under_way_;
  std::uint64_t steps_ = 0;
  std::uint64_t violations_ = 0;
};

}  // namespace collided::simulation
