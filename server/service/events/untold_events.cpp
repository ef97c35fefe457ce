#include "server/service/events/untold_events.hpp"

namespace collided::engine::service {

void UntoldEvents::keep(const EventColumns& events, const Stamp& stamp, bool is_of_fences, std::int64_t now_ns) {
  frames_.push_back({.events = events, .stamp = stamp, .is_of_fences = is_of_fences, .kept_ns = now_ns});
  event_count_ += events.size();
  forget_old(now_ns);
}

void UntoldEvents::forget_old(std::int64_t now_ns) {
  while (!frames_.empty() && (event_count_ > kMostEvents || now_ns - frames_.front().kept_ns > kReachNs)) {
    event_count_ -= frames_.front().events.size();
    frames_.pop_front();
  }
}

}  // namespace collided::engine::service
