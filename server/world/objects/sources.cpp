#include "server/world/objects/sources.hpp"

#include <algorithm>
#include <utility>

namespace collided::engine {

std::uint32_t Sources::take_number(std::uint64_t publisher) {
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
    if (const auto gap = gaps_.find(publisher); gap != gaps_.end()) sources_[entry->second].gap_ns = gap->second;
  }
  return entry->second;
}

/// Time below the floor is decided, so the source counts as known up to there.
void Sources::begin_use(Source& source) {
  ++used_count_;
  source.known_ns = std::max(source.known_ns, floor_ns_);
  source.settled_ns = std::max(source.settled_ns, floor_ns_);
}

std::uint32_t Sources::add_object(std::uint64_t publisher) {
  const std::uint32_t number = take_number(publisher);
  if (!sources_[number].is_used()) begin_use(sources_[number]);
  ++sources_[number].object_count;
  return number;
}

void Sources::expect_objects(std::uint64_t publisher) {
  Source& source = sources_[take_number(publisher)];
  if (!source.is_used()) begin_use(source);
  source.may_bring = true;
}

/// A publisher that still gives instants keeps its source: it may define an object again, and its settled time must not
/// change.
void Sources::remove_object(std::uint32_t source) {
  --sources_[source].object_count;
  if (sources_[source].is_used()) return;
  --used_count_;
  if (!sources_[source].is_timed) release(source);
}

void Sources::release(std::uint32_t source) {
  numbers_.erase(sources_[source].publisher);
  sources_[source] = {};
  free_.push_back(source);
}

void Sources::note_streamed(std::uint32_t source) {
  Source& of = sources_[source];
  if (!of.is_streamed) of.streamed_ns = of.settled_ns;
  of.is_streamed = true;
}

const Source* Sources::find(std::uint64_t publisher) const {
  const auto found = numbers_.find(publisher);
  return found == numbers_.end() ? nullptr : &sources_[found->second];
}

void Sources::set_gap(std::uint64_t publisher, std::int64_t gap_ns) {
  if (gap_ns == kDefaultGapNs) gaps_.erase(publisher);
  else gaps_[publisher] = gap_ns;
  const auto found = numbers_.find(publisher);
  if (found == numbers_.end()) return;
  Source& source = sources_[found->second];
  if (!source.is_timed && !source.is_streamed) source.gap_ns = gap_ns;
}

std::optional<std::uint32_t> Sources::advance(std::uint64_t publisher, std::int64_t time_ns, bool is_only_alive) {
  const auto found = numbers_.find(publisher);
  if (found == numbers_.end()) return std::nullopt;
  Source& source = sources_[found->second];
  // known_of() subtracts the gap of a streamed source.
  if (is_only_alive && !source.is_streamed) time_ns = std::max(time_ns - source.gap_ns, source.known_ns);
  else time_ns = source.admitted(time_ns);
  if (time_ns > source.known_ns) {
    source.before_ns = source.known_ns;
    source.known_ns = time_ns;
    source.instants.push_back(time_ns);
  }
  source.has_spoken = true;
  return std::exchange(source.is_timed, true) ? std::nullopt : std::optional(found->second);
}

void Sources::lose(std::uint64_t publisher) {
  const auto found = numbers_.find(publisher);
  if (found == numbers_.end()) return;
  Source& source = sources_[found->second];
  source.is_timed = false;
  const bool was_used = source.is_used();
  source.may_bring = false;
  if (source.is_used()) return;
  if (was_used) --used_count_;
  release(found->second);
}

bool Sources::is_over_floor_again(const Source& source) const {
  return source.settled_of(0) < floor_ns_ && source.known_ns >= floor_ns_;
}

bool Sources::is_any_behind_floor() const {
  return std::any_of(sources_.begin(), sources_.end(),
                     [&](const Source& source) { return source.is_used() && source.settled_of(0) < floor_ns_; });
}

void Sources::begin_step(std::int64_t world_time_ns, bool is_any_open) {
  bool is_any_timed = false;
  std::int64_t oldest_ns = kForEver;
  std::int64_t newest_ns = 0;
  needs_common_time_ = is_any_open;
  is_any_over_floor_again_ = false;
  for (Source& source : sources_) {
    if (!source.is_used()) continue;
    is_any_timed = is_any_timed || source.is_timed || source.has_spoken;
    oldest_ns = std::min(oldest_ns, source.settled_ns);
    newest_ns = std::max(newest_ns, source.settled_ns);
    if (!source.is_timed) source.known_ns = std::max(source.known_ns, world_time_ns);
    is_any_over_floor_again_ = is_any_over_floor_again_ || is_over_floor_again(source);
    const auto is_new = [&](std::int64_t instant) { return instant > source.settled_ns; };
    const bool has_several = std::count_if(source.instants.begin(), source.instants.end(), is_new) > 1;
    const bool leaves_out = source.posed_count > 0 && source.posed_count < source.object_count;
    const bool is_uneven = has_several || leaves_out || source.has_own_motions;
    needs_common_time_ = needs_common_time_ || source.is_streamed || (source.has_spoken && is_uneven);
  }
  // A source that was behind when the last step ended must catch up, even if no source gives instants any more.
  needs_common_time_ = needs_common_time_ || (used_count_ > 1 && (is_any_timed || oldest_ns < newest_ns));
}

std::int64_t Sources::settled_ns(std::int64_t world_time_ns) const {
  std::int64_t settled_ns = world_time_ns;
  for (const Source& source : sources_) {
    if (source.is_used()) settled_ns = std::min(settled_ns, source.known_of(0));
  }
  return settled_ns;
}

std::int64_t Sources::settled_at_rest_ns(std::int64_t now_ns) const {
  std::int64_t settled_ns = now_ns;
  for (const Source& source : sources_) {
    if (source.is_used() && source.is_timed) settled_ns = std::min(settled_ns, source.known_of(0));
  }
  return settled_ns;
}

void Sources::end_step() {
  std::int64_t newest_ns = 0;
  std::int64_t oldest_ns = kForEver;
  for (Source& source : sources_) {
    source.settled_ns = std::max(source.settled_ns, source.known_ns);
    source.posed_count = 0;
    source.has_own_motions = source.has_spoken = false;
    if (!source.is_used()) continue;
    newest_ns = std::max(newest_ns, source.settled_ns);
    oldest_ns = std::min(oldest_ns, source.settled_ns - (source.is_streamed ? source.gap_ns : 0));
  }
  if (used_count_ > 0) floor_ns_ = std::max({floor_ns_, oldest_ns, newest_ns - kLongestMemoryNs});
  for (Source& source : sources_) {
    const std::int64_t unasked_ns = source.is_used() ? floor_ns_ : source.known_ns;
    std::erase_if(source.instants, [&](std::int64_t instant) { return instant <= unasked_ns; });
  }
}

}  // namespace collided::engine
