#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "server/world/objects/snapshot.hpp"

namespace collided::engine {
namespace {

TEST(SnapshotRing, ALeaseKeepsItsStateWhileTheWriterGoesOn) {
  SnapshotRing ring;
  ring.writable()->version = 1;
  ring.publish();
  const SnapshotRing::Lease kept = ring.newest();
  for (std::uint64_t version = 2; version < 100; ++version) {
    ring.writable()->version = version;
    ring.publish();
  }
  EXPECT_EQ(kept->version, 1u);
  EXPECT_EQ(ring.newest()->version, 99u);
}

TEST(SnapshotRing, TheWriterIsToldWhenReadersHoldEverything) {
  SnapshotRing ring;
  std::vector<SnapshotRing::Lease> leases;
  while (Snapshot* free = ring.writable()) {
    free->version = leases.size();
    ring.publish();
    leases.push_back(ring.newest());
    ASSERT_LE(leases.size(), SnapshotRing::kStates);
  }
  EXPECT_GE(leases.size(), SnapshotRing::kStates - 1);
  leases.erase(leases.begin());
  EXPECT_NE(ring.writable(), nullptr);
}

// Every field of a state is written with the version; a reader that sees two versions in one state read a torn one.
TEST(SnapshotRing, ReadersNeverSeeAHalfWrittenState) {
  SnapshotRing ring;
  std::atomic<bool> stop{false};
  std::atomic<std::uint64_t> torn{0};
  std::vector<std::thread> readers;
  for (int r = 0; r < 3; ++r) {
    readers.emplace_back([&] {
      while (!stop.load()) {
        const SnapshotRing::Lease lease = ring.newest();
        const std::uint64_t version = lease->version;
        if (lease->epoch != version || lease->world_time_ns != static_cast<std::int64_t>(version)) ++torn;
      }
    });
  }
  for (std::uint64_t version = 1; version <= 200'000; ++version) {
    Snapshot* next = ring.writable();
    if (next == nullptr) continue;
    next->version = version;
    next->epoch = version;
    next->world_time_ns = static_cast<std::int64_t>(version);
    ring.publish();
  }
  stop = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(torn.load(), 0u);
}

}  // namespace
}  // namespace collided::engine
