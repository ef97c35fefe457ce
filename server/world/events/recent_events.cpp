#include "server/world/events/recent_events.hpp"

#include <algorithm>
#include <cmath>

namespace collided::engine {
namespace {

std::int64_t before(std::int64_t time_ns, double seconds) {
  return time_ns - static_cast<std::int64_t>(std::llround(seconds * 1e9));
}

}  // namespace

std::int64_t RecentEvent::low_ns() const { return before(world_time_ns, event.bracket_low_s); }
std::int64_t RecentEvent::high_ns() const { return before(world_time_ns, event.bracket_high_s); }

void RecentEvents::note(const Event& event, std::int64_t world_time_ns, std::string_view a, std::string_view b) {
  const std::lock_guard lock(mutex_);
  const std::size_t place = event.sequence % kMost;
  if (place >= ring_.size()) ring_.resize(std::min(kMost, std::max(place + 1, 2 * ring_.size())));
  RecentEvent& noted = ring_[place];
  noted.event = event;
  noted.world_time_ns = world_time_ns;
  noted.a = a;
  noted.b = b;
  last_ = event.sequence;
  count_ = std::min(kMost, count_ + 1);
}

RecentEvents::SequenceSpan RecentEvents::known() const {
  if (count_ == 0) return {};
  return {last_ - count_ + 1, last_};
}

RecentEvents::SequenceSpan RecentEvents::span() const {
  const std::lock_guard lock(mutex_);
  return known();
}

std::optional<RecentEvent> RecentEvents::find(std::uint64_t sequence) const {
  const std::lock_guard lock(mutex_);
  const SequenceSpan span = known();
  if (count_ == 0 || sequence < span.first || sequence > span.last) return std::nullopt;
  return at(sequence);
}

std::vector<RecentEvent> RecentEvents::last_of(ObjectId b, std::size_t most) const {
  const std::lock_guard lock(mutex_);
  std::vector<RecentEvent> found;
  for (std::size_t i = 0; i < count_ && found.size() < most; ++i) {
    const RecentEvent& noted = at(last_ - i);
    if (noted.event.of.b == b) found.push_back(noted);
  }
  std::reverse(found.begin(), found.end());
  return found;
}

}  // namespace collided::engine
