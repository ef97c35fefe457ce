#include "server/service/ingest/source_clock.hpp"

#include <algorithm>

namespace collided::engine::service {
namespace {

/// Within this range the difference of two stamps does not overflow; it reaches 146 years beyond 1970.
constexpr std::int64_t kMostSourceNs = std::int64_t{1} << 62;

}  // namespace

WorldStamp SourceClock::stamp(std::int64_t source_ns, std::int64_t received_ns) {
  is_without_stamps_ = source_ns <= 0 || source_ns > kMostSourceNs;
  if (is_without_stamps_) {
    newest_ns_ = std::max(newest_ns_, received_ns);
    return {newest_ns_, StampKind::none};
  }
  const std::int64_t ahead_ns = source_ns - source_ns_;
  const bool jumped = started_ && (ahead_ns < -kMostOffNs || is_ahead_of_time(source_ns, received_ns) ||
                                   was_only_late(source_ns, received_ns));
  if (!started_ || jumped) {
    const std::int64_t off_ns = received_ns - source_ns;
    offset_ns_ = off_ns >= -kMostOffNs && off_ns <= kMostOffNs ? 0 : off_ns;
  }
  const std::int64_t time_ns = source_ns + offset_ns_;
  if (started_ && !jumped && time_ns < newest_ns_) return {++newest_ns_, StampKind::late};
  started_ = true;
  note_transit(source_ns, received_ns);
  source_ns_ = source_ns;
  received_ns_ = received_ns;
  // World time never decreases, not even at a jump: earlier reports stay valid.
  newest_ns_ = std::max(newest_ns_ + (jumped ? 1 : 0), time_ns);
  return {newest_ns_, jumped ? StampKind::jumped : StampKind::good};
}

std::optional<std::int64_t> SourceClock::alive_at(std::int64_t source_ns, std::int64_t received_ns) const {
  if (!started_ || source_ns <= 0 || source_ns > kMostSourceNs) return std::nullopt;
  if (is_ahead_of_time(source_ns, received_ns)) return std::nullopt;
  return source_ns + offset_ns_;
}

/// Whether a stamp is a jump ahead: it has advanced by more than the server's time since the last stamp, and lies in
/// the server's future. The second test spares batches that a network held back: they come together, but their stamps
/// lie in the past.
bool SourceClock::is_ahead_of_time(std::int64_t source_ns, std::int64_t received_ns) const {
  const bool is_faster = source_ns - source_ns_ > kMostOffNs + std::max<std::int64_t>(0, received_ns - received_ns_);
  return is_faster && source_ns + offset_ns_ > received_ns + kMostOffNs;
}

/// Whether a clock that seemed to be behind is not: its first batch was delayed, and this one was not. Every server
/// decides the same, whenever it first hears the publisher.
bool SourceClock::was_only_late(std::int64_t source_ns, std::int64_t received_ns) const {
  return offset_ns_ > 0 && received_ns - source_ns <= kMostOffNs && received_ns - source_ns >= -kMostOffNs;
}

void SourceClock::note_transit(std::int64_t source_ns, std::int64_t received_ns) {
  if (received_ns - window_began_ns_ >= kWindowNs) {
    least_before_ns_ = received_ns - window_began_ns_ < 2 * kWindowNs ? least_ns_ : kNoBatch;
    least_ns_ = kNoBatch;
    window_began_ns_ = received_ns;
  }
  least_ns_ = std::min(least_ns_, received_ns - source_ns);
}

std::optional<std::int64_t> SourceClock::behind_ns() const {
  const std::int64_t least_ns = std::min(least_ns_, least_before_ns_);
  if (least_ns == kNoBatch || offset_ns_ != 0) return std::nullopt;
  return least_ns;
}

}  // namespace collided::engine::service
