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

/// Events of a recording's period that it lacks.
struct MissingEvents {
  std::uint64_t lost = 0;     // missing events, by sequence number
  std::uint64_t undated = 0;  // contacts at its begin with an unknown beginning, which counts as the recording's begin
  bool is_begin_doubtful = false;  // the contacts found at its begin do not match the server's count
};

/// Passes a recording to a new `watch`: the initial contacts as `open`, then its events one by one. Initial contacts
/// are derived from the shards before and after its begin, and from events that end contacts without a recorded
/// beginning. `News` is Event or StandingNews.
///
/// time_is  called with the time of each message, since 1970 by the recorder's clock, before `watch` receives it
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

/// Orders of events. happened: by happened(). sequence: by number, as a watch reports them, each `open` before its
/// later events.
enum class EventOrder { happened, sequence };

/// Selects from events that a WatchStateOf emits: contacts open before `from` as `open`, then the events from `from` to
/// `to`, both inclusive.
template <class News>
std::vector<News> in_window(std::vector<News> events, std::chrono::nanoseconds from, std::chrono::nanoseconds to,
                            EventOrder order);

}  // namespace collided::client
