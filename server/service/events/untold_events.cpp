#include "server/service/events/untold_events.hpp"

namespace collided::engine::service {

void UntoldEvents::keep(const EventColumns& events, const Stamp& stamp, bool is_of_fences, std::int64_t now_ns) {
  if (events.size() == 0) return;
  frames_.push_back({.events = events, .stamp = stamp, .is_of_fences = is_of_fences, .kept_ns = now_ns});
  event_count_ += events.size();
  for (; event_count_ > kMostEvents; frames_.pop_front()) event_count_ -= frames_.front().events.size();
}

}  // namespace collided::engine::service
