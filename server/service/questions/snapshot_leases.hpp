#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "server/world/objects/snapshot.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// Keeps the state on which a request of several chunks is answered, from its first chunk to its last. The world's
/// states are a ring, and pinning all of them would stop its writer. So only a few states are kept, for a limited time;
/// beyond that the oldest request loses its state, and its later chunks are refused.
///
/// threads  any
class SnapshotLeases {
 public:
  static constexpr std::size_t kMostStates = 8;  // of SnapshotRing::kStates; workers and the writer need the rest
  static constexpr std::size_t kMostRequests = 1'024;
  static constexpr std::int64_t kPatienceNs = 2'000'000'000;  // longest pause between two chunks
  static constexpr std::int64_t kLongestNs = 30'000'000'000;  // from the first chunk to the last
  /// A new request joins a state this young rather than pushing out an old request.
  static constexpr std::int64_t kSharedAgeNs = 20'000'000;

  explicit SnapshotLeases(const World& world) : world_(world) { entries_.reserve(kMostRequests + 1); }

  /// The state for one chunk; nothing for a later chunk whose request is not, or no longer, kept.
  ///
  /// least_version  the oldest state that will do; greater than any version: only the newest
  std::optional<SnapshotRing::Lease> take(std::uint64_t client, std::uint64_t request, std::uint32_t chunk_index,
                                          std::uint32_t chunk_count, std::uint64_t least_version, std::int64_t now_ns);
  /// Lets go of states whose requests have run out of time.
  void expire(std::int64_t now_ns);
  /// Requests that keep a state.
  std::size_t size() const;

 private:
  struct Entry {
    std::uint64_t client;
    std::uint64_t request;
    std::uint32_t chunks_left;
    std::int64_t pinned_ns;
    std::int64_t heard_ns;  // when its newest chunk came
    SnapshotRing::Lease lease;
  };
  std::size_t states() const;
  SnapshotRing::Lease pin(std::uint64_t least_version, std::int64_t now_ns);

  const World& world_;
  mutable std::mutex mutex_;
  std::vector<Entry> entries_;  // oldest first
};

}  // namespace collided::engine::service
