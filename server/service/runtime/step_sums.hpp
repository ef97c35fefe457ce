#pragma once

#include <atomic>
#include <cstdint>

#include "idl/answers/figures.hpp"
#include "server/service/runtime/duration_counts.hpp"

namespace collided::engine::service {

/// A number that one thread writes and any thread reads, without a lock.
class Tally {
 public:
  void add(std::uint64_t more) { set(get() + more); }
  void set(std::uint64_t value) { value_.store(value, std::memory_order_relaxed); }
  std::uint64_t get() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

/// Sums of the world's thread since the start. Each number is exact; two numbers may be a step apart.
struct StepSums {
  Tally steps;
  Tally stalled_steps;  // steps retried because readers held every free state
  Tally take_ns;        // taking samples and jobs, between steps
  Tally update_ns;      // filling the next state
  Tally index_ns;       // indexing its movers
  Tally test_ns;        // finding and testing candidates
  Tally events_ns;      // finding what began and ended
  Tally publish_ns;     // writing events, contacts, probes
  PairCounts<Tally> pairs;
  FenceCounts<Tally> fences;
  DurationCounts durations;  // whole steps, with what they publish
  PoseCounts<Tally> poses;   // this and the next at the last status, poses.applied at the newest step
  StampCounts<Tally> stamps;
};

}  // namespace collided::engine::service
