#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "idl/topics.hpp"

namespace collided::engine::service {

/// How a publisher's stamp was turned into world time.
enum class StampKind : std::uint8_t {
  good,    // used unchanged
  none,    // the batch has no stamp: the time of its reception is used
  jumped,  // the clock went back or ahead by more than a lease: no motion connects the poses
  late,    // before an earlier stamp: becomes the next nanosecond, since current poses are news all the same
};

/// A batch's time in the world.
struct WorldStamp {
  std::int64_t time_ns = 0;  // world time; never decreases
  StampKind kind = StampKind::good;
};

/// Turns one publisher's stamps into world time, which is the publishers' own: a stamp is used unchanged, to the
/// nanosecond. Only a clock that is more than a lease off the server's (nanoseconds since boot, another epoch) gets an
/// offset, such that its first batch happened when it was received; so does a clock after a jump. It loses the offset,
/// with a jump, once a batch comes in time: then only the first one was late.
///
/// threads  one
class SourceClock {
 public:
  /// Clocks that differ by no more than this are treated as equal.
  static constexpr std::int64_t kMostOffNs = wire_contract::kPublisherLeaseNs;

  /// The world time of the next batch.
  ///
  /// source_ns    the publisher's stamp; 0: none
  /// received_ns  server's clock
  WorldStamp stamp(std::int64_t source_ns, std::int64_t received_ns);
  /// The world time of a sign of life, which comes between batches and may be stamped a little after the next one.
  /// Nothing before the first good stamp, and for a clock that has jumped ahead.
  std::optional<std::int64_t> alive_at(std::int64_t source_ns, std::int64_t received_ns) const;
  /// Whether a good stamp has come.
  bool has_started() const { return started_; }
  /// Whether the last batch had no stamp. From such a publisher even an empty batch is informative: nothing moved until
  /// now.
  bool is_without_stamps() const { return is_without_stamps_; }
  /// Shortest time from stamp to reception within the last one to two seconds, ns: the transport's delay plus how far
  /// the publisher's clock is behind the server's. Negative if the clock is ahead by more than the delay. Nothing if no
  /// stamp was good, or the clock has an offset.
  std::optional<std::int64_t> behind_ns() const;

 private:
  static constexpr std::int64_t kNoBatch = std::numeric_limits<std::int64_t>::max();
  static constexpr std::int64_t kWindowNs = 1'000'000'000;

  bool is_ahead_of_time(std::int64_t source_ns, std::int64_t received_ns) const;
  bool was_only_late(std::int64_t source_ns, std::int64_t received_ns) const;
  void note_transit(std::int64_t source_ns, std::int64_t received_ns);

  bool started_ = false;
  bool is_without_stamps_ = false;
  std::int64_t offset_ns_ = 0;    // world time minus the publisher's; 0 if within kMostOffNs
  std::int64_t source_ns_ = 0;    // of the last good stamp
  std::int64_t received_ns_ = 0;  // reception of the same batch
  std::int64_t newest_ns_ = 0;    // greatest world time so far
  std::int64_t window_began_ns_ = 0;
  std::int64_t least_ns_ = kNoBatch;         // shortest time from stamp to reception, in this window
  std::int64_t least_before_ns_ = kNoBatch;  // and in the window before
};

}  // namespace collided::engine::service
