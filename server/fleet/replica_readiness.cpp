#include "server/fleet/replica_readiness.hpp"

namespace collided::engine::service {

void ReplicaReadiness::note_turn() {
  const std::int64_t now_ns = steady_ns();
  const std::int64_t last_ns = turned_ns_.load();
  // Before the turn counts: a question that comes in between must not find it open.
  if (last_ns != 0 && now_ns - last_ns > kStoodStillNs) doubt();
  turned_ns_.store(now_ns);
}

void ReplicaReadiness::note_compared(std::int64_t instant_ns, bool is_same) {
  if (!is_same) return doubt();
  const std::lock_guard lock(mutex_);
  if (instant_ns <= doubted_ns_) return;
  const std::int64_t now_ns = steady_ns();
  const std::int64_t before_ns = compared_ns_.load();
  // After a pause nobody knows what the states in it lack.
  if (before_ns == 0 || now_ns - before_ns > kComparedForNs) whole_since_ns_.store(instant_ns);
  compared_ns_.store(now_ns);
}

void ReplicaReadiness::doubt() {
  const std::lock_guard lock(mutex_);
  doubted_ns_ = clock_.now_ns();
  compared_ns_.store(0);
}

bool ReplicaReadiness::is_open() const {
  const std::int64_t now_ns = steady_ns();
  const std::int64_t compared_ns = compared_ns_.load();
  return compared_ns != 0 && now_ns - compared_ns <= kComparedForNs && now_ns - turned_ns_.load() <= kStoodStillNs;
}

}  // namespace collided::engine::service
