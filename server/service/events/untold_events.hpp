#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "server/service/events/event_writer.hpp"

namespace collided::engine::service {

/// The newest events of a silent standby, published once it takes over from the primary. Only the subscribers know
/// which of them the primary still published; they ignore those that they have received.
///
/// Columns  EventColumns or StandingColumns
/// threads  one
template <class Columns>
class UntoldEvents {
 public:
  struct UntoldFrame {
    Columns events;
    Stamp stamp;
    std::int64_t kept_ns = 0;  // steady clock
  };

  /// Keeps a frame, and drops those more than kMostEvents older.
  void keep(const Columns& events, const Stamp& stamp, std::int64_t now_ns) {
    if (events.size() == 0) return;
    frames_.push_back({.events = events, .stamp = stamp, .kept_ns = now_ns});
    event_count_ += events.size();
    for (; event_count_ > kMostEvents; frames_.pop_front()) event_count_ -= frames_.front().events.size();
  }
  /// Calls tell(const UntoldFrame&) with the frames that the primary may not have published, in order, and clears all.
  /// Their numbers are consecutive: begins after the last frame with an event from before the time since which both
  /// servers find the same.
  template <class Tell>
  void tell_all(const SpokenBefore& before, Tell&& tell) {
    for (std::size_t i = first_after(before.same_from_ns); i < frames_.size(); ++i) {
      if (frames_[i].kept_ns >= before.heard_ns - kReachNs) tell(frames_[i]);
    }
    frames_.clear();
    event_count_ = 0;
  }

 private:
  /// Bound on the time between publishing a step on one server and keeping it on the other.
  static constexpr std::int64_t kReachNs = 2'000'000'000;
  /// A subscriber remembers this many received events.
  static constexpr std::size_t kMostEvents = wire_contract::kEventTopic.keep_last;

  std::size_t first_after(std::int64_t same_from_ns) const {
    std::size_t first = 0;
    if (same_from_ns == 0) return first;
    for (std::size_t i = 0; i < frames_.size(); ++i)
      if (earliest_ns(frames_[i]) <= same_from_ns) first = i + 1;
    return first;
  }
  /// The beginning of the earliest bracket, world time.
  static std::int64_t earliest_ns(const UntoldFrame& frame) {
    double longest_ago_s = 0;
    for (const double low_s : frame.events.bracket_lows) longest_ago_s = std::max(longest_ago_s, low_s);
    return frame.stamp.world_time_ns - static_cast<std::int64_t>(1e9 * longest_ago_s);
  }

  std::deque<UntoldFrame> frames_;
  std::size_t event_count_ = 0;  // of all frames
};

}  // namespace collided::engine::service
