#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "server/world/objects/snapshot.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// Keeps the state on which a request of several chunks is answered, from its first chunk to its last.
/// The world has a ring of states: who pinned them all would stop it. So only a few different ones are kept, for a
/// limited time; the oldest request gives way, and its later chunks are refused.
///
/// threads  any
class SnapshotLeases {
 public:
  static constexpr std::size_t kMostStates = 8;  // of SnapshotRing::kStates, the rest is for workers and the writer
  static constexpr std::size_t kMostRequests = 1'024;
  static constexpr std::int64_t kPatienceNs = 2'000'000'000;  // from one chunk to the next
  static constexpr std::int64_t kLongestNs = 30'000'000'000;  // from the first chunk to the last
  /// A new request joins a state this young rather than pushing out an old request.
  static constexpr std::int64_t kSharedAgeNs = 20'000'000;

  explicit SnapshotLeases(const World& world) : world_(world) { entries_.reserve(kMostRequests + 1); }

  /// The state for one chunk; none for a later chunk whose request is not (or no longer) here.
  /// least_version  no older state will do; beyond the newest: only that one
  std::optional<SnapshotRing::Lease> take(std::uint64_t client, std::uint64_t request, std::uint32_t chunk_index,
                                          std::uint32_t chunk_count, std::uint64_t least_version, std::int64_t now_ns);
  void expire(std::int64_t now_ns);
  std::size_t size() const;

 private:
  struct Entry {
    std::uint64_t client;
    std::uint64_t request;
    std::uint32_t chunks_left;
    std::int64_t pinned_ns;
    std::int64_t heard_ns;  // of its newest chunk
    SnapshotRing::Lease lease;
  };
  std::size_t states() const;
  SnapshotRing::Lease pin(std::uint64_t least_version, std::int64_t now_ns);

  const World& world_;
  mutable std::mutex mutex_;
  std::vector<Entry> entries_;  // oldest first
};

}  // namespace collided::engine::service
