#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "idl/commands.hpp"

namespace collided::engine::service {

/// One step of the world: what it took in, decided and wrote, and how long each stage took. Each stage has a clock
/// reading of its own at both ends; `whole_ns` is measured apart, so the stages' sum can be compared with it.
struct StepTrace {
  std::uint64_t version = 0;
  std::int64_t world_time_ns = 0;
  std::int64_t whole_ns = 0;  // from the first sample that it waited for to its last write, waiting left out
  std::int64_t take_ns = 0;   // samples and jobs since the step before
  std::int64_t update_ns = 0;
  std::int64_t index_ns = 0;
  std::int64_t test_ns = 0;
  std::int64_t events_ns = 0;
  std::int64_t publish_ns = 0;
  std::uint32_t moved = 0;
  std::uint32_t candidates = 0;
  std::uint32_t exact_tests = 0;
  std::uint32_t contacts = 0;
  std::uint32_t events = 0;
};

/// The newest steps. One thread adds, any thread reads; neither waits for longer than a copy of them takes.
class StepTraces {
 public:
  static constexpr std::size_t kMost = wire_contract::command::kMostSteps;

  void add(const StepTrace& trace) {
    const std::scoped_lock lock(mutex_);
    traces_[count_++ % kMost] = trace;
  }
  /// At most `most` of them, the oldest first.
  std::vector<StepTrace> newest(std::size_t most) const {
    const std::scoped_lock lock(mutex_);
    std::vector<StepTrace> newest;
    for (std::size_t i = count_ - std::min({most, count_, kMost}); i < count_; ++i)
      newest.push_back(traces_[i % kMost]);
    return newest;
  }

 private:
  mutable std::mutex mutex_;
  std::array<StepTrace, kMost> traces_;
  std::size_t count_ = 0;
};

}  // namespace collided::engine::service
