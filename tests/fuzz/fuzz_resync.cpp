#include <optional>
#include <random>
#include <set>

#include "client/library/watching/watch_state.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/service/wire/watch_model.hpp"

// A server that does what the bytes say, two a turn, with a line between that loses, delays, repeats and reorders as they
// say. What is told alternates at any time; and once the line is good again, what was told is what holds.

namespace {

using namespace collided;
using test::Model;
using test::Pair;

class Watcher {
 public:
  template <class Heard>
  void hear(const Heard& heard) {
    now_ += std::chrono::milliseconds(1);
    state_.hear(heard, now_);
  }
  void hear_persisted(const client::HeardFrame& frame) { state_.hear_persisted(frame); }
  /// Long enough to take the server for silent.
  void pass() { now_ += std::chrono::milliseconds(400); }
  const std::set<Pair>& open() const { return open_; }
  bool in_step() const { return state_.in_step(); }

 private:
  void emit(const Event& event) {
    const Pair pair{std::stoull(event.a), std::stoull(event.b)};
    if (event.kind == EventKind::ended) {
      fuzz::require(open_.erase(pair) == 1, "what ends has begun");
    } else if (event.kind != EventKind::began && event.kind != EventKind::open) {
      fuzz::require(open_.contains(pair), "what persists, is contained or emerges has begun");
    } else {
      fuzz::require(open_.insert(pair).second, "nothing begins twice");
    }
  }
  std::set<Pair> open_;
  client::Clock::time_point now_{std::chrono::milliseconds(1'000)};
  client::WatchState state_{[this](const Event& event) { emit(event); }};
};

Pair pair_of(std::uint8_t byte) {
  const std::uint64_t a = byte % 6;
  return {a, a + 1 + byte / 6 % 5};
}

client::HeardFrame step(Model& server, std::uint8_t byte) {
  const Pair pair = pair_of(byte);
  return server.contacts().contains(pair) ? server.ended(pair) : server.began(pair);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Watcher watcher;
  Model server(1);
  std::uint64_t epoch = 1;
  std::optional<client::HeardFrame> delayed;
  std::optional<client::HeardShard> old_shard;
  for (std::size_t i = 0; i + 1 < size && i < 4'000; i += 2) {
    const std::uint8_t what = data[i + 1];
    switch (data[i] % 16) {
      case 0: static_cast<void>(step(server, what)); break;  // lost
      case 1: delayed = step(server, what); break;
      case 2:
        if (delayed) watcher.hear(*delayed);
        break;
      case 3: watcher.hear(server.shard(what % wire_contract::kContactShards)); break;
      case 4: watcher.hear(server.shard(pair_of(what))); break;
      case 5: old_shard = server.shard(pair_of(what)); break;
      case 6:
        if (old_shard) watcher.hear(*old_shard);
        break;
      case 7: watcher.hear(server.bookmark(what % 8 != 0)); break;
      case 8:
        if (what < 32) server = Model(++epoch);
        break;
      case 9:
        if (what < 8) watcher.pass();
        break;
      case 10:
        if (!server.contacts().empty()) watcher.hear_persisted(server.persisted(server.contacts().begin()->first));
        break;
      default: watcher.hear(step(server, what)); break;
    }
  }
  for (std::uint8_t shard = 0; shard < wire_contract::kContactShards; ++shard) watcher.hear(server.shard(shard));
  watcher.hear(server.bookmark());
  watcher.hear(server.bookmark());
  std::set<Pair> truth;
  for (const auto& [pair, episode] : server.contacts()) truth.insert(pair);
  collided::fuzz::require(watcher.in_step(), "a good line brings it into step");
  collided::fuzz::require(watcher.open() == truth, "what was told is what holds");
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  std::vector<std::string> seeds;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::mt19937 random(seed);
    std::string bytes(100 * seed, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    seeds.push_back(bytes);
  }
  return seeds;
}
