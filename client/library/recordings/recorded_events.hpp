#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "client/library/connection/names.hpp"
#include "client/library/recordings/recorded_items.hpp"
#include "client/library/watching/watch_state.hpp"

namespace collided::client {

/// What a recording lacks of its events.
struct MissingEvents {
  std::uint64_t lost = 0;     // by their sequence: heard of, not in it
  std::uint64_t undated = 0;  // contacts that held at its begin, since when is not in it: they count from its begin
  bool is_begin_doubtful = false;  // what the server told of its contacts does not fit those that were found
};

/// Lets `watch`, which has heard nothing yet, hear a recording: what held at its begin as `open`, then its events one by
/// one. What held is taken from everything that the recording says of it: the shards from before and after its begin, and
/// events that end what did not begin in it.
MissingEvents hear_recording(const RecordedItems& recorded, Names& names, WatchState& watch);

/// Time of the first and of the last sample that came while it was recorded, since 1970 by the recorder's clock.
struct RecordedSpan {
  std::chrono::nanoseconds begin{0};
  std::chrono::nanoseconds end{0};
};
RecordedSpan span_of(const RecordedItems& recorded);

/// Of events as a WatchState emits them: what held before `from` as `open`, then what happened from `from` to `to`, both
/// included, in order of world time.
std::vector<Event> in_window(std::vector<Event> events, std::chrono::nanoseconds from, std::chrono::nanoseconds to);

}  // namespace collided::client
