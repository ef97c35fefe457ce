#pragma once

#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "server/fleet/world_comparison.hpp"
#include "tests/simulation/seeded_choices.hpp"
#include "tests/simulation/simulated_publisher.hpp"
#include "tests/simulation/simulated_server.hpp"

namespace collided::simulation {
using namespace engine;

/// One seed of a fleet: a server that speaks, one that stands by and takes its place where it is killed, stands still or
/// hands over, and then a new one that stands by; publishers whose clocks differ and who say all again when they are asked;
/// lines that delay what each server hears. One server more hears the same and never fails: what it finds is what watchers
/// are to be told, each event once.
class SimulatedFleet : private SeededChoices {
 public:
  SimulatedFleet(std::uint64_t seed, std::FILE* to);
  void run();

  std::uint64_t steps() const { return steps_; }
  std::uint64_t violations() const { return violations_; }
  std::uint64_t takeovers() const { return takeovers_; }

 private:
  static constexpr std::int64_t kTickNs = 10'000'000;

  struct Sent {
    std::int64_t time_ns;
    std::variant<service::DefinitionSample, service::PoseSample> what;
  };
  /// When the newest sample of a publisher arrives: those behind it later.
  struct Line {
    std::int64_t definitions_ns = 0;
    std::int64_t poses_ns = 0;
  };
  struct Member {
    std::unique_ptr<SimulatedServer> server;
    std::vector<Sent> under_way = {};
    std::map<std::uint64_t, Line> lines = {};  // by publisher
    std::int64_t stands_still_until_ns = 0;
    std::int64_t noted_digest_ns = 0;
    service::WorldComparison comparison = {};  // with the one that speaks
    std::uint64_t differed = 0;                // instants in a row, as of the last look
    bool is_same = false;
    std::int64_t same_from_ns = 0;  // the first of the instants since when it is
  };
  struct Host {
    SimulatedPublisher publisher;
    std::int64_t period = 1;                              // of its flushes, in ticks
    std::map<std::uint32_t, std::int64_t> added_ns = {};  // by object
    std::int64_t says_again_ns = 0;                       // it has been asked to define everything again; 0: not
    std::int64_t all_said_until_ns = 0;                   // its batches say that it has
  };

  std::int64_t any_period();
  void tick(bool is_calm);
  void act(Host& host, std::size_t number);
  void flush(Host& host, bool everything);
  void define_all(Host& host);
  void send(const service::DefinitionSample& sample);
  void send(const service::PoseSample& sample);
  template <class Work>
  void for_each_member(Work&& work);
  std::unique_ptr<Member> make_member(std::uint64_t epoch, Voice voice);
  void deliver(Member& member);
  void compare_worlds();
  void ask_publishers_again();
  void trouble();
  void replace_primary();
  void take_over();
  void settle_truth();
  void violation(const std::string& what);

  std::uint64_t seed_;
  std::FILE* to_;
  Payload payload_;
  std::int64_t now_ns_ = 1'000'000'000;
  bool is_still_ = false;  // nothing new is sent
  std::uint64_t epoch_ = 0;
  std::vector<Host> hosts_;
  std::unique_ptr<Member> expected_;  // never fails
  std::unique_ptr<Member> primary_;   // null: it was killed
  std::unique_ptr<Member> standby_;   // null: there is none
  std::int64_t heard_ns_ = 0;         // when the primary was heard last
  std::int64_t standby_starts_ns_ = 0;
  std::unique_ptr<Member> resumed_;  // stood still, and has yet to learn that its place was taken
  std::uint64_t steps_ = 0;
  std::uint64_t takeovers_ = 0;
  std::uint64_t violations_ = 0;
};

}  // namespace collided::simulation
