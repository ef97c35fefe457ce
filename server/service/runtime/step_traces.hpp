#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "idl/commands.hpp"
#include "idl/answers/figures.hpp"

namespace collided::engine::service {

/// The newest steps. One thread adds, any thread reads; neither waits longer than copying them takes.
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
