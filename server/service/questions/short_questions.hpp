#pragma once

#include <cstdint>

#include "idl/dds.hpp"

namespace collided::engine::service {

/// Which questions the reading thread may answer itself. Whoever reads keeps poses and other questions waiting, so it
/// is told how long each took and stays away for a while after two in a row that took too long.
/// One thread.
class ShortQuestions {
 public:
  /// A single ray, sphere, box or nearest point of the newest state, and none took long of late.
  bool is_short(const wire::Query& query, std::int64_t now_ns) const;
  void took(std::int64_t started_ns, std::int64_t ended_ns);

 private:
  static constexpr std::int64_t kLongNs = 50'000;
  static constexpr std::int64_t kPauseNs = 100'000'000;
  static constexpr int kMostLong = 2;  // one may be the scheduler's doing

  std::int64_t not_before_ns_ = 0;
  int long_in_a_row_ = 0;
};

}  // namespace collided::engine::service
