#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/oracle/meeting_oracle.hpp"

namespace collided::testing_support {
using namespace engine;

/// A body and who poses it; its instants count from the round's beginning.
struct CrossingBody {
  std::size_t publisher = 0;
  oracle::MovingBody moving;
};

/// Bodies by their number, with their places at that time.
struct CrossingFlush {
  std::int64_t stamp_ns = 0;
  std::int64_t sent_ns = 0;  // never before an earlier one
  std::vector<std::pair<std::size_t, Vec3>> poses;
};

/// The gap of a publisher that streams; the others have the default, which is longer than their periods.
inline constexpr std::int64_t kStreamedGapNs = 250'000'000;

struct CrossingPublisher {
  bool streamed = false;
  double rate_hz = 0;
  std::vector<CrossingFlush> flushes;
};

/// Two to five publishers, each with a rate from 1 to 240 Hz, a phase and jitter of its own, and pairs of bodies that come
/// near each other, each pair in a lane far from the others. Bodies 2k and 2k + 1 are a pair; their instants are all that
/// their events may depend on. All stand still before the first flush and after the last, which all publishers have at
/// the same times.
struct CrossingRound {
  static constexpr std::int64_t kLongNs = 2'000'000'000;
  std::vector<CrossingBody> bodies;
  std::vector<CrossingPublisher> publishers;
};

/// The same for the same seed, in every process.
CrossingRound crossing_round(std::uint64_t seed, std::size_t lanes);

}  // namespace collided::testing_support
