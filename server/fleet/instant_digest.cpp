#include "server/fleet/instant_digest.hpp"

#include <algorithm>
#include <utility>

#include "idl/topics.hpp"

namespace collided::engine::service {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;
/// What is older than this has come and was stepped over, unless its publisher is behind: then it is not settled.
constexpr std::int64_t kPatienceNs = 1'000'000'000;
/// A publisher that lives and has said nothing for so long counts as one whose objects rest: else a world of such ones, which
/// DDS allows, could never be compared. Longer than any gap: a publisher that gives signs of life is behind by its own.
constexpr std::int64_t kSilentNs = wire_contract::kMostGapNs + 2 * kSecondNs;

}  // namespace

bool DigestMaker::make(std::int64_t now_ns, std::int64_t settled_ns) {
  const SnapshotRing::Lease newest = world_.newest();
  // In a world that has not stepped since, who has spoken since has rested; what the others will say of that time nobody knows.
  const bool is_quiet = newest->world_time_ns <= now_ns - kPatienceNs - kSecondNs;
  if (settled_ns <= now_ns - kSilentNs) settled_ns = now_ns;
  if (!is_quiet) settled_ns = newest->settled_ns;
  settled_ns = std::min(std::max(settled_ns, newest->settled_ns), now_ns - kPatienceNs);
  const std::int64_t instant_ns = settled_ns / kSecondNs * kSecondNs;
  if (instant_ns <= newest_.time_ns) return false;
  if (instant_ns < newest->world_time_ns) return make_past(*newest, instant_ns);
  if (state_ && newest->version == quiet_version_) {
    newest_.time_ns = instant_ns;
    return true;
  }
  quiet_version_ = newest->version;
  keep(instant_ns, std::make_shared<const Snapshot>(*newest));
  return true;
}

/// The newest second up to this one at which every object is known: one that streams may be behind its publisher's time.
bool DigestMaker::make_past(const Snapshot& newest, std::int64_t instant_ns) {
  const std::int64_t earliest_ns = std::max(newest_.time_ns + kSecondNs, instant_ns - 3 * kSecondNs);
  for (; instant_ns >= earliest_ns; instant_ns -= kSecondNs) {
    std::shared_ptr<const Snapshot> state = world_.memory().at(instant_ns);
    if (!state) return false;
    // Those of lost publishers rest where they were said to be last, in both worlds.
    if (state->stale_objects.size() > newest.stale_objects.size()) continue;
    quiet_version_ = 0;
    keep(instant_ns, std::move(state));
    return true;
  }
  return false;
}

void DigestMaker::keep(std::int64_t instant_ns, std::shared_ptr<const Snapshot> state) {
  state_ = std::move(state);
  newest_ = {.time_ns = instant_ns, .digest = digest_of(*state_)};
}

std::uint64_t DigestMaker::scene_fingerprint() {
  const SnapshotRing::Lease newest = world_.newest();
  if (scenes_ != newest->scenes) {
    scenes_ = newest->scenes;
    fingerprint_ = engine::scene_fingerprint(*newest);
  }
  return fingerprint_;
}

}  // namespace collided::engine::service
