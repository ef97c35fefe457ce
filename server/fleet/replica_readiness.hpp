#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

#include "idl/topics.hpp"
#include "server/service/runtime/clock.hpp"

namespace collided::engine::service {

/// Whether a replica may answer: its world was found the same as the primary's a moment ago, and since then it has not
/// stood still, so that it has what the primary has but for what is on its way.
///
/// threads  any
class ReplicaReadiness {
 public:
  /// So long a comparison counts. There is one a second, of an instant up to 2.5 s ago.
  static constexpr std::int64_t kComparedForNs = 4'000'000'000;
  /// A world's thread that takes no turn for so long has stood still: what came meanwhile may be lost, or not taken yet.
  static constexpr std::int64_t kStoodStillNs = wire_contract::kStatusLostNs;

  explicit ReplicaReadiness(const WorldClock& clock) : clock_(clock) {}

  /// The world's thread takes a turn; to be called ten times a second.
  void note_turn();
  /// The worlds were compared as they were at this instant of world time.
  void note_compared(std::int64_t instant_ns, bool is_same);
  /// What this server holds may lack something: nothing is answered before an instant later than now is found the same.
  void doubt();

  bool is_open() const;
  /// World time from which on the states that are remembered are the primary's, while is_open().
  std::int64_t whole_since_ns() const { return whole_since_ns_.load(); }

 private:
  const WorldClock& clock_;
  std::atomic<std::int64_t> turned_ns_{0};    // steady clock; 0: never
  std::atomic<std::int64_t> compared_ns_{0};  // when the worlds were found the same, steady clock; 0: not since a doubt
  std::atomic<std::int64_t> whole_since_ns_{0};
  std::mutex mutex_;             // for changes of compared_ns_, and the next one
  std::int64_t doubted_ns_ = 0;  // world time
};

}  // namespace collided::engine::service
