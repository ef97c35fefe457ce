#include "tests/simulation/simulated_watcher.hpp"

#include <algorithm>
#include <chrono>

namespace collided::simulation {

using client::HeardShard;

SimulatedWatcher::SimulatedWatcher(std::string name, const Line& line, std::uint64_t seed, bool has_watermarks,
                                   Violation violation)
    : name_(std::move(name)),
      has_watermarks_(has_watermarks),
      line_(line),
      random_(seed),
      violation_(std::move(violation)),
      cut_off_until_ns_(line.joins_ns),
      state_([this](const Event& event) { emit(event); }) {}

void SimulatedWatcher::emit(const Event& event) {
  const auto say = [&](const char* what) {
    violation_(name_ + ": " + event.a + " x " + event.b + ", event " + std::to_string(event.sequence) + " of epoch " +
               std::to_string(event.epoch) + ' ' + what);
  };
  events_.push_back(event);
  const NamedPair pair = std::minmax(event.a, event.b);
  if (event.kind == EventKind::ended) {
    if (open_.erase(pair) == 0) say("ended without having begun");
    // Why it ended while nobody could hear is not known; that it did is.
    if (event.reason == EndReason::none && !event.resync) say("ended without a reason");
  } else if (!open_.insert(pair).second) {
    say("began twice");
  }
  if (event.epoch < last_epoch_) say("came from an earlier life of the server");
  if (event.epoch == last_epoch_ && event.sequence < last_sequence_) say("came out of order");
  if (event.epoch > last_epoch_) reported_.clear();
  last_epoch_ = event.epoch;
  last_sequence_ = event.sequence;
  if (event.resync || event.kind == EventKind::open) return;
  reported_.push_back(event.sequence);
  // In a fleet publishers' clocks are near, and none is new to a server that has forgotten it: then time waits for each of
  // them. Each server rounds its times once.
  if (!has_watermarks_) return;
  constexpr std::chrono::nanoseconds kRounded{2};
  const auto settled = state_.settled();
  if (settled && settled->life.epoch == event.epoch && happened(event) + kRounded < settled->to)
    say("is older than a watermark before it");
}

void SimulatedWatcher::hear(const Heard& message, std::int64_t now_ns) {
  const client::Clock::time_point now{std::chrono::nanoseconds(now_ns)};
  std::visit([&](const auto& heard) { state_.hear(heard, now); }, message);
}

void SimulatedWatcher::hear_due(std::int64_t now_ns) {
  while (!delayed_.empty() && delayed_.begin()->first <= now_ns) {
    const Heard message = std::move(delayed_.begin()->second);
    delayed_.erase(delayed_.begin());
    hear(message, now_ns);
  }
}

void SimulatedWatcher::send(const Heard& message, std::int64_t now_ns) {
  if (const auto* shard = std::get_if<HeardShard>(&message)) newest_shards_[{shard->from.epoch, shard->shard}] = *shard;
  hear_due(now_ns);
  if (now_ns < cut_off_until_ns_) return;
  if (chance(line_.partitions)) cut_off_until_ns_ = now_ns + up_to(line_.longest_partition_ns);
  if (chance(line_.loss)) return;
  if (chance(line_.repeats)) delayed_.emplace(now_ns + up_to(line_.longest_delay_ns), message);
  if (line_.longest_delay_ns > 0 && chance(0.3)) {
    delayed_.emplace(now_ns + up_to(line_.longest_delay_ns), message);
  } else {
    hear(message, now_ns);
  }
}

void SimulatedWatcher::calm(std::int64_t now_ns) {
  line_ = {};
  cut_off_until_ns_ = 0;
  for (const auto& [time, message] : delayed_) hear(message, now_ns);
  delayed_.clear();
  for (const auto& [number, shard] : newest_shards_) hear(shard, now_ns);
}

void SimulatedWatcher::compare(const std::set<NamedPair>& truth) {
  if (!state_.in_step()) violation_(name_ + " is not in step at the end");
  if (open_ == truth) return;
  violation_(name_ + " holds " + std::to_string(open_.size()) + " contacts at the end, the truth has " +
             std::to_string(truth.size()));
}

}  // namespace collided::simulation
