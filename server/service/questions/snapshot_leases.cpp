#include "server/service/questions/snapshot_leases.hpp"

#include <algorithm>

namespace collided::engine::service {

/// How many different states are pinned; leases of the same state point to the same snapshot.
std::size_t SnapshotLeases::states() const {
  std::size_t count = 0;
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
    const bool seen =
        std::any_of(entries_.begin(), entry, [&](const Entry& other) { return &*other.lease == &*entry->lease; });
    if (!seen) ++count;
  }
  return count;
}

/// The state for a new request: the newest, or where too many states are pinned a young one that is pinned already, or
/// else the newest at the cost of the oldest requests.
SnapshotRing::Lease SnapshotLeases::pin(std::uint64_t least_version, std::int64_t now_ns) {
  if (entries_.size() >= kMostRequests) entries_.erase(entries_.begin());
  SnapshotRing::Lease newest = world_.newest();
  const bool pinned_already =
      std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) { return &*entry.lease == &*newest; });
  if (pinned_already || states() < kMostStates) return newest;
  const Entry& young = entries_.back();
  if (young.lease->version >= least_version && now_ns - young.pinned_ns <= kSharedAgeNs) return young.lease;
  while (states() >= kMostStates) entries_.erase(entries_.begin());
  return newest;
}

std::optional<SnapshotRing::Lease> SnapshotLeases::take(std::uint64_t client, std::uint64_t request,
                                                        std::uint32_t chunk_index, std::uint32_t chunk_count,
                                                        std::uint64_t least_version, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.client == client && entry.request == request;
  });
  if (found == entries_.end()) {
    if (chunk_index != 0) return std::nullopt;
    SnapshotRing::Lease lease = pin(least_version, now_ns);
    entries_.push_back({client, request, chunk_count - 1, now_ns, now_ns, lease});
    return lease;
  }
  SnapshotRing::Lease lease = found->lease;
  found->heard_ns = now_ns;
  if (--found->chunks_left == 0) entries_.erase(found);
  return lease;
}

void SnapshotLeases::expire(std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [&](const Entry& entry) {
    return now_ns - entry.heard_ns > kPatienceNs || now_ns - entry.pinned_ns > kLongestNs;
  });
}

std::size_t SnapshotLeases::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

}  // namespace collided::engine::service
