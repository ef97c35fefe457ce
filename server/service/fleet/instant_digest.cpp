#include "server/service/fleet/instant_digest.hpp"

#include <algorithm>

namespace collided::engine::service {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;
/// What is older than this has come and was stepped over, unless its publisher is behind: then it is not settled.
constexpr std::int64_t kPatienceNs = 1'000'000'000;

}  // namespace

bool DigestMaker::make(std::int64_t now_ns) {
  const SnapshotRing::Lease newest = world_.newest();
  // A world that has not stepped since is at the instant as it is now.
  const bool is_quiet = newest->world_time_ns <= now_ns - kPatienceNs - kSecondNs;
  const std::int64_t settled_ns = is_quiet ? now_ns - kPatienceNs : std::min(newest->settled_ns, now_ns - kPatienceNs);
  const std::int64_t instant_ns = settled_ns / kSecondNs * kSecondNs;
  if (instant_ns <= newest_.time_ns) return false;
  if (is_quiet && newest->version == quiet_version_) {
    newest_.time_ns = instant_ns;
    return true;
  }
  std::shared_ptr<const Snapshot> state =
      is_quiet ? std::make_shared<const Snapshot>(*newest) : world_.memory().at(instant_ns);
  if (!state) return false;
  quiet_version_ = is_quiet ? newest->version : 0;
  state_ = std::move(state);
  newest_ = {.time_ns = instant_ns, .digest = digest_of(*state_)};
  return true;
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
