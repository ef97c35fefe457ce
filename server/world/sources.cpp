#include "server/world/sources.hpp"

#include <algorithm>

namespace collided {

std::uint32_t Sources::add_object(std::uint64_t publisher) {
  const auto [entry, is_new] = numbers_.try_emplace(publisher, 0);
  if (is_new) {
    if (free_.empty()) {
      entry->second = static_cast<std::uint32_t>(sources_.size());
      sources_.emplace_back();
    } else {
      entry->second = free_.back();
      free_.pop_back();
    }
    sources_[entry->second] = {.publisher = publisher, .instants = {}};
    ++used_count_;
  }
  ++sources_[entry->second].object_count;
  return entry->second;
}

void Sources::remove_object(std::uint32_t source) {
  if (--sources_[source].object_count > 0) return;
  numbers_.erase(sources_[source].publisher);
  sources_[source] = {};
  free_.push_back(source);
  --used_count_;
}

const Source* Sources::find(std::uint64_t publisher) const {
  const auto found = numbers_.find(publisher);
  return found == numbers_.end() ? nullptr : &sources_[found->second];
}

void Sources::advance(std::uint64_t publisher, std::int64_t time_ns) {
  const auto found = numbers_.find(publisher);
  if (found == numbers_.end()) return;
  Source& source = sources_[found->second];
  time_ns = source.admitted(time_ns);
  if (source.is_timed && time_ns <= source.known_ns) return;
  source.before_ns = source.is_timed ? source.known_ns : time_ns;
  source.known_ns = time_ns;
  source.is_timed = true;
  source.instants.push_back(time_ns);
}

void Sources::lose(std::uint64_t publisher) {
  const auto found = numbers_.find(publisher);
  if (found != numbers_.end()) sources_[found->second].is_timed = false;
}

std::int64_t Sources::birth_ns(std::uint32_t source, std::int64_t world_time_ns) const {
  if (source == kResting || !sources_[source].is_timed) return world_time_ns;
  const Source& of = sources_[source];
  const auto first = std::find_if(of.instants.begin(), of.instants.end(), [&](std::int64_t instant) { return instant > of.settled_ns; });
  return std::min(world_time_ns, first == of.instants.end() ? of.known_ns : *first);
}

void Sources::begin_step(std::int64_t world_time_ns, bool is_any_open) {
  bool is_any_timed = false;
  needs_common_time_ = is_any_open;
  for (Source& source : sources_) {
    if (source.object_count == 0) continue;
    is_any_timed = is_any_timed || source.is_timed;
    if (!source.is_timed) source.known_ns = std::max(source.settled_ns, world_time_ns);
    const auto is_new = [&](std::int64_t instant) { return instant > source.settled_ns; };
    const bool has_several = std::count_if(source.instants.begin(), source.instants.end(), is_new) > 1;
    const bool leaves_out = source.posed_count > 0 && source.posed_count < source.object_count;
    needs_common_time_ = needs_common_time_ || source.is_streamed || (source.is_timed && (has_several || leaves_out));
  }
  needs_common_time_ = needs_common_time_ || (is_any_timed && used_count_ > 1);
}

void Sources::end_step() {
  std::int64_t newest_ns = 0;
  std::int64_t oldest_ns = kForEver;
  for (Source& source : sources_) {
    if (source.object_count == 0) continue;
    source.settled_ns = std::max(source.settled_ns, source.known_ns);
    source.posed_count = 0;
    newest_ns = std::max(newest_ns, source.settled_ns);
    oldest_ns = std::min(oldest_ns, source.settled_ns - (source.is_streamed ? kStreamGapNs : 0));
  }
  oldest_asked_ns_ = used_count_ == 0 ? 0 : std::max(oldest_ns, newest_ns - kLongestMemoryNs);
  for (Source& source : sources_) {
    std::erase_if(source.instants, [&](std::int64_t instant) { return instant <= oldest_asked_ns_; });
  }
}

}  // namespace collided
