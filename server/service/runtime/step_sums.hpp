#pragma once

#include <atomic>
#include <cstdint>

#include "server/service/runtime/duration_counts.hpp"

namespace collided::engine::service {

/// A number that one thread writes and any thread reads.
class Tally {
 public:
  void add(std::uint64_t more) { set(get() + more); }
  void set(std::uint64_t value) { value_.store(value, std::memory_order_relaxed); }
  std::uint64_t get() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

/// What the world's thread has done since the start. Each number is right; two of them may be a step apart.
struct StepSums {
  Tally steps;
  Tally stalled_steps;
  Tally take_ns;     // samples and jobs taken in, between steps
  Tally update_ns;   // the next state filled
  Tally index_ns;    // its movers indexed
  Tally test_ns;     // candidates found and tested
  Tally publish_ns;  // events, contacts, probes written
  Tally moved;       // objects, once a step
  Tally candidates;  // pairs of movers
  Tally filtered;    // pairs of movers near each other that their layers, masks or groups keep from meeting
  Tally exact_tests;
  Tally undecided;
  Tally in_doubt;  // pairs, after the newest step
  Tally swept;
  Tally kept_apart;
  DurationCounts durations;  // of whole steps, what they publish included

  Tally poses_applied;
  // Poses that came and moved nothing; as of the last status.
  Tally poses_late;
  Tally poses_unknown;
  Tally poses_refused;
  Tally poses_superseded;
  Tally poses_dropped;
  // Batches whose stamp was taken for another; as of the last status.
  Tally stamps_late;
  Tally stamps_jumped;
  Tally stamps_missing;
};

}  // namespace collided::engine::service
