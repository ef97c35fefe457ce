#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "idl/topics.hpp"

namespace collided::engine::service {

/// How far one publisher's samples have been applied without a gap. Definitions and poses share one series of numbers
/// but come on two topics, each in order. A number that both topics have passed will never come, since a newer sample
/// has replaced it; a number that only one topic has passed may still be in flight on the other for a while.
///
/// threads  one
class SequenceWatermark {
 public:
  /// A gap older than this counts as lost: reliable delivery between two processes in one network takes far less.
  static constexpr std::int64_t kGapPatienceNs = 100'000'000;

  /// Call this when a sample was applied or finally refused: it is no longer awaited.
  void apply_definition(std::uint64_t sequence, std::int64_t now_ns) {
    definitions_ = std::max(definitions_, sequence);
    note(sequence, now_ns);
  }
  void apply_pose(std::uint64_t sequence, std::int64_t now_ns) {
    poses_ = std::max(poses_, sequence);
    note(sequence, now_ns);
  }
  /// Gives up the gaps once they have lasted kGapPatienceNs.
  void settle(std::int64_t now_ns);

  /// Every sample up to this number has been applied or will never come. 0: none has come yet.
  std::uint64_t through() const { return through_; }

 private:
  /// DDS keeps no more in flight, so a longer list means that the gap before it is lost.
  static constexpr std::size_t kMostAhead = wire_contract::kPoseTopic.keep_last;
  void note(std::uint64_t sequence, std::int64_t now_ns);
  void absorb();

  std::uint64_t through_ = 0;
  std::uint64_t definitions_ = 0;  // greatest number applied of each topic
  std::uint64_t poses_ = 0;
  std::vector<std::uint64_t> ahead_;  // applied beyond the first gap, ascending
  std::int64_t gap_since_ns_ = 0;
};

}  // namespace collided::engine::service
