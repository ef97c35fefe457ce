#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "client/library/connection/names.hpp"
#include "client/library/recordings/recorded_items.hpp"
#include "client/library/watching/watch_state.hpp"
#include "collided/recording.hpp"

namespace collided::client {

/// What a recording lacks of the events in its time.
struct MissingEvents {
  std::uint64_t lost = 0;     // events that are missing, by the sequence numbers
  std::uint64_t undated = 0;  // contacts at its begin whose own beginning is not known: it counts as the recording's
  bool is_begin_doubtful = false;  // the contacts found at its begin do not match what the server counted
};

/// Passes a recording to a new `watch`: what held at its begin as `open`, then its events one by one. What held is
/// found from everything that the recording says of it: the shards before and after its begin, and events that end
/// contacts which did not begin in it. `News` are an Event or StandingNews.
///
/// time_is  called with the time of each message, since 1970 by the recorder's clock, before `watch` hears it
template <class News>
MissingEvents hear_recording(const RecordedItems& recorded, Names& names, WatchStateOf<News>& watch,
                             const std::function<void(std::chrono::nanoseconds)>& time_is = {});

/// The times of the first and the last sample received while recording, since 1970 by the recorder's clock.
struct RecordedSpan {
  std::chrono::nanoseconds begin{0};
  std::chrono::nanoseconds end{0};
};
RecordedSpan span_of(const RecordedItems& recorded);
/// A time that may be relative to the recording, since 1970.
std::chrono::nanoseconds resolved(const RunTime& time, const RecordedSpan& span);

/// happened: by happened(). sequence: as a watch reports them, by their numbers, each `open` before what follows it.
enum class EventOrder { happened, sequence };

/// Selects from events as a WatchStateOf emits them: what held before `from` as `open`, then what happened from `from` to
/// `to`, both included.
template <class News>
std::vector<News> in_window(std::vector<News> events, std::chrono::nanoseconds from, std::chrono::nanoseconds to,
                            EventOrder order);

}  // namespace collided::client
