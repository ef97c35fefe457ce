#pragma once

#include <atomic>
#include <cstdint>

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

/// What the world's thread has done since the start. Each number is exact; two numbers may be a step apart.
struct StepSums {
  Tally steps;
  Tally stalled_steps;  // times that a step was tried again, since readers held every free state
  Tally take_ns;        // taking samples and jobs, between steps
  Tally update_ns;      // filling the next state
  Tally index_ns;       // indexing its movers
  Tally test_ns;        // finding and testing candidates
  Tally events_ns;      // what began and ended
  Tally publish_ns;     // writing events, contacts, probes
  Tally moved;          // objects, each counted once a step
  Tally candidates;     // pairs of movers
  Tally filtered;       // pairs of movers near each other that their layers, masks or groups keep from meeting
  Tally exact_tests;
  Tally undecided;
  Tally in_doubt;        // pairs after the newest step
  Tally fences;          // with the bands of margins, after the newest step, and the next two
  Tally fences_entered;  // that something is in
  Tally in_fences;       // objects, each counted once for every fence that it is in
  Tally fence_events;
  Tally fences_cut_short;  // searches that ended at their limit of looks
  Tally swept;
  Tally kept_apart;
  DurationCounts durations;  // whole steps, with what they publish

  Tally poses_applied;
  // Poses that were received and moved nothing, as of the last status.
  Tally poses_late;
  Tally poses_unknown;
  Tally poses_refused;
  Tally poses_superseded;
  Tally poses_dropped;
  // Batches whose stamp was not taken as it is, as of the last status.
  Tally stamps_late;
  Tally stamps_jumped;
  Tally stamps_missing;
};

}  // namespace collided::engine::service
