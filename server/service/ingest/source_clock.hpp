#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "idl/topics.hpp"

namespace collided::engine::service {

/// What one publisher's stamp means in world time.
enum class StampKind : std::uint8_t {
  good,
  none,    // it says none: the batch's reception counts
  jumped,  // its clock went back or ahead by more than a lease: no way leads there
  late,    // before what it has said already: where things are now is news all the same
};

struct WorldStamp {
  std::int64_t time_ns = 0;
  StampKind kind = StampKind::good;
};

/// World time is the publishers' own: a stamp is taken as it is, to the nanosecond. A clock that is a lease and more off the
/// server's (nanoseconds since boot, another epoch) counts from where its first batch came; so does one after a jump.
class SourceClock {
 public:
  /// Of clocks that are taken as one.
  static constexpr std::int64_t kMostOffNs = wire_contract::kPublisherLeaseNs;

  /// source_ns  0: the publisher says none
  WorldStamp stamp(std::int64_t source_ns, std::int64_t received_ns);
  /// Whether the last batch said no time: the next one without may say something all the same.
  bool is_without_stamps() const { return is_without_stamps_; }
  /// How long after its stamp the quickest batch of the last second or two came: its way, and what its clock is behind the
  /// server's, or below 0 ahead of it. Nothing where no stamp was good, or the clock counts from another epoch.
  std::optional<std::int64_t> behind_ns() const;

 private:
  static constexpr std::int64_t kNoBatch = std::numeric_limits<std::int64_t>::max();
  static constexpr std::int64_t kWindowNs = 1'000'000'000;

  bool is_ahead_of_time(std::int64_t source_ns, std::int64_t received_ns) const;
  void note_way(std::int64_t source_ns, std::int64_t received_ns);

  bool started_ = false;
  bool is_without_stamps_ = false;
  std::int64_t offset_ns_ = 0;  // of world time, from the publisher's
  std::int64_t source_ns_ = 0;  // of the last good stamp
  std::int64_t received_ns_ = 0;
  std::int64_t newest_ns_ = 0;  // world time
  std::int64_t window_began_ns_ = 0;
  std::int64_t least_ns_ = kNoBatch;         // from stamp to reception, in this window
  std::int64_t least_before_ns_ = kNoBatch;  // and in the one before
};

}  // namespace collided::engine::service
