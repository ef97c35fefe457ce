#pragma once

#include <cstdint>

#include "idl/dds.hpp"

namespace collided::engine::service {

/// Decides which questions the listener's thread may answer itself. While it answers, poses and other questions wait,
/// so after two answers in a row that took too long it leaves questions to the workers for a while.
///
/// threads  one
class ShortQuestions {
 public:
  /// A single ray, sphere, box or nearest point of the newest state, unless recent ones took long.
  bool is_short(const wire::Query& query, std::int64_t now_ns) const;
  /// Call this after each answer; steady clock.
  void took(std::int64_t started_ns, std::int64_t ended_ns);

 private:
  static constexpr std::int64_t kLongNs = 50'000;        // an answer that takes longer is a long one
  static constexpr std::int64_t kPauseNs = 100'000'000;  // without answers after kMostLong in a row
  static constexpr int kMostLong = 2;                    // a single one may be the scheduler's doing

  std::int64_t not_before_ns_ = 0;
  int long_in_a_row_ = 0;
};

}  // namespace collided::engine::service
