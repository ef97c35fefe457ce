#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "idl/topics.hpp"

namespace collided::engine::service {

/// How far one publisher's samples have been applied without gap. Its definitions and poses share one series of
/// numbers but come on two topics, each in order: a number that both topics have passed will never come, since a newer
/// sample has replaced it; one that only one topic has passed may still be under way on the other, for a while.
class SequenceWatermark {
 public:
  /// A gap older than this was lost; reliable delivery between two processes of one network takes far less.
  static constexpr std::int64_t kGapPatienceNs = 100'000'000;

  void apply_definition(std::uint64_t sequence, std::int64_t now_ns) {
    definitions_ = std::max(definitions_, sequence);
    note(sequence, now_ns);
  }
  void apply_pose(std::uint64_t sequence, std::int64_t now_ns) {
    poses_ = std::max(poses_, sequence);
    note(sequence, now_ns);
  }
  /// Gives up gaps that have waited too long.
  void settle(std::int64_t now_ns);

  /// Everything up to here has been applied or will never come.
  std::uint64_t through() const { return through_; }

 private:
  static constexpr std::size_t kMostAhead = wire_contract::kPoseTopic.keep_last;  // so many may be under way
  void note(std::uint64_t sequence, std::int64_t now_ns);
  void absorb();

  std::uint64_t through_ = 0;
  std::uint64_t definitions_ = 0;
  std::uint64_t poses_ = 0;
  std::vector<std::uint64_t> ahead_;  // applied beyond the first gap, ascending
  std::int64_t gap_since_ns_ = 0;
};

}  // namespace collided::engine::service
