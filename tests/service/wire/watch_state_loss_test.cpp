// Random streams of events over a line that loses, repeats and reorders them.
#include "client/library/watching/watch_state.hpp"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "tests/service/wire/watch_model.hpp"
#include "tests/service/wire/watch_state_fixture.hpp"

namespace collided {
namespace {

class Simulation {
 public:
  explicit Simulation(std::uint64_t seed) : random_(seed) {}
  bool chance(double probability) { return std::uniform_real_distribution<>(0, 1)(random_) < probability; }
  std::uint64_t below(std::uint64_t limit) {
    return std::uniform_int_distribution<std::uint64_t>(0, limit - 1)(random_);
  }

  Pair any_pair() {
    const std::uint64_t a = below(6);
    return {a, a + 1 + below(5)};
  }
  HeardFrame step(Model& server) {
    const Pair pair = any_pair();
    return server.contacts().contains(pair) ? server.ended(pair) : server.began(pair);
  }

 private:
  std::mt19937_64 random_;
};

std::uint64_t seed() {
  const char* const given = std::getenv("COLLIDED_SEED");
  return given != nullptr ? std::stoull(given) : std::random_device{}();
}

// Whatever is lost, repeated or delayed: told events alternate (checked in emit), and when the line is good again what
// was told is what holds.
TEST_F(WatchStateTest, LossyLineEndsInTheTruth) {
  const std::uint64_t first_seed = seed();
  SCOPED_TRACE("COLLIDED_SEED=" + std::to_string(first_seed));
  for (std::uint64_t run = 0; run < 300 && !HasFailure(); ++run) {
    SCOPED_TRACE("run " + std::to_string(run));
    Simulation line(first_seed + run);
    open_.clear();
    last_epoch_ = last_sequence_ = 0;
    state_ = WatchState([this](const Event& event) { emit(event); });
    Model server(1);
    std::uint64_t epoch = 1;
    std::optional<HeardFrame> delayed;
    for (int i = 0; i < 400; ++i) {
      if (line.chance(0.005)) { server = Model(++epoch); }
      const HeardFrame frame = line.step(server);
      if (line.chance(0.9)) { hear(frame); }
      if (!server.contacts().empty() && line.chance(0.2)) {
        state_.hear_persisted(server.persisted(server.contacts().begin()->first));
      }
      if (delayed && line.chance(0.5)) { hear(*std::exchange(delayed, std::nullopt)); }
      if (line.chance(0.05)) { delayed = frame; }
      if (line.chance(0.3)) { hear(server.shard(line.any_pair())); }
      if (line.chance(0.1)) { hear(server.bookmark(line.chance(0.9))); }
    }
    for (int shard = 0; shard < static_cast<int>(wire_contract::kContactShards); ++shard) {
      hear(server.shard(static_cast<std::uint8_t>(shard)));
    }
    hear(server.bookmark());
    hear(server.bookmark());
    std::set<Pair> truth;
    for (const auto& [pair, episode] : server.contacts()) { truth.insert(pair); }
    EXPECT_EQ(open_, truth);
    EXPECT_TRUE(state_.in_step());
  }
}

TEST_F(WatchStateTest, GoodLineTellsEveryEventOnceAndNeverResyncs) {
  const std::uint64_t first_seed = seed();
  SCOPED_TRACE("COLLIDED_SEED=" + std::to_string(first_seed));
  Simulation line(first_seed);
  Model server(1);
  hear(server.bookmark());
  for (int i = 0; i < 5'000; ++i) {
    const HeardFrame frame = line.step(server);
    hear(frame);
    const Event& event = frame.entries[0].event;
    ASSERT_EQ(told(), Lines{std::string(kWhat[static_cast<int>(event.kind)]) + ' ' + event.a + ' ' + event.b});
    if (line.chance(0.05)) {
      hear(server.shard(line.any_pair()));
      hear(server.bookmark());
    }
  }
  EXPECT_EQ(state_.resyncs(), 0u);
}

}  // namespace
}  // namespace collided
