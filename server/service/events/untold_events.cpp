#include "server/service/events/untold_events.hpp"

#include <algorithm>

namespace collided::engine::service {
namespace {

/// The beginning of the earliest bracket, world time.
std::int64_t earliest_ns(const UntoldEvents::UntoldFrame& frame) {
  double longest_ago_s = 0;
  for (const double low_s : frame.events.bracket_lows) longest_ago_s = std::max(longest_ago_s, low_s);
  return frame.stamp.world_time_ns - static_cast<std::int64_t>(1e9 * longest_ago_s);
}

}  // namespace

void UntoldEvents::keep(const EventColumns& events, const Stamp& stamp, bool is_of_fences, std::int64_t now_ns) {
  if (events.size() == 0) return;
  frames_.push_back({.events = events, .stamp = stamp, .is_of_fences = is_of_fences, .kept_ns = now_ns});
  event_count_ += events.size();
  for (; event_count_ > kMostEvents; frames_.pop_front()) event_count_ -= frames_.front().events.size();
}

std::size_t UntoldEvents::first_after(std::int64_t same_from_ns) const {
  std::size_t first = 0;
  if (same_from_ns == 0) return first;
  for (std::size_t i = 0; i < frames_.size(); ++i)
    if (earliest_ns(frames_[i]) <= same_from_ns) first = i + 1;
  return first;
}

}  // namespace collided::engine::service
