#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "client/library/connection/errors.hpp"
#include "client/library/recordings/recorded_events.hpp"
#include "client/library/watching/fence_news.hpp"
#include "client/library/watching/margin_news.hpp"
#include "client/library/watching/nearest_news.hpp"
#include "client/library/watching/pair_filter.hpp"
#include "collided/recording.hpp"
#include "idl/fence_ids.hpp"

namespace collided {
namespace {

/// Events of the fences' topics by what they are about.
struct FenceEventKinds {
  std::vector<Event> fences, margins, nearest;

  void take(const Event& event) {
    if (wire_contract::is_nearest_id(event.b_id)) nearest.push_back(event);
    else if (client::is_band_name(event.b)) margins.push_back(event);
    else fences.push_back(event);
  }
};

std::vector<FenceEvent> fence_news(const std::vector<Event>& events) {
  client::FenceNews news;
  std::vector<FenceEvent> told;
  for (const Event& event : events) {
    for (FenceEvent& one : news.take(event)) told.push_back(std::move(one));
  }
  return told;
}

std::vector<NearestEvent> nearest_news(const std::vector<Event>& events, const NearestWatchOptions& wanted) {
  client::NearestNews news;
  std::vector<NearestEvent> told;
  for (const Event& event : events) {
    std::optional<NearestEvent> one = news.take(event);
    if (one && client::is_wanted(*one, wanted)) told.push_back(std::move(*one));
  }
  return told;
}

void warn_of(const client::MissingEvents& missing, const std::string& path, std::vector<std::string>& warnings) {
  const auto warn = [&](const std::string& what) { warnings.push_back(path + ": " + what); };
  if (missing.lost > 0)
    warn(std::to_string(missing.lost) +
         " events of fences are not in it; what they changed is marked resync as far as it shows");
  if (missing.undated > 0)
    warn("of " + std::to_string(missing.undated) +
         " stays in fences it tells the end but not since when: at least from its begin");
  if (missing.is_begin_doubtful) warn("it does not tell of everyone who was in a fence at its begin");
}

}  // namespace

Result<RecordedFenceEvents> recorded_fence_events(const std::string& path, const RecordedEventsOptions& options) try {
  const client::RecordedItems recorded = client::read_items(client::read_recording(path), path, "Nothing was read");
  const client::RecordedSpan span = client::span_of(recorded);
  const auto from = options.from ? client::resolved(*options.from, span) : std::chrono::nanoseconds::min();
  const auto to = options.to ? client::resolved(*options.to, span) : std::chrono::nanoseconds::max();
  if (from > to) return client::bad_input("the end of what is asked for lies before its begin", "nothing was read");
  FenceEventKinds kinds;
  client::Names names;
  client::WatchState watch([&](const Event& event) { kinds.take(event); });
  const client::MissingEvents missing = client::hear_recording(recorded, names, watch, WatchOf::fences);
  const auto window = [&](std::vector<Event>& events) {
    return client::in_window(std::move(events), from, to, client::EventOrder::sequence);
  };
  // As the watches of each kind: fences by the event's two names, the others by those that the event is made of.
  std::erase_if(kinds.fences,
                [&](const Event& event) { return !client::is_wanted(event, options.only, options.skip); });
  RecordedFenceEvents told{.fences = fence_news(window(kinds.fences)),
                           .margins = {},
                           .nearest = nearest_news(window(kinds.nearest), {.only = options.only, .skip = options.skip}),
                           .begin = span.begin,
                           .end = span.end,
                           .lost = missing.lost,
                           .warnings = recorded.warnings};
  for (const Event& event : window(kinds.margins)) {
    if (auto one = client::margin_news(event, {.only = options.only, .skip = options.skip}))
      told.margins.push_back(std::move(*one));
  }
  warn_of(missing, path, told.warnings);
  return told;
} catch (const std::runtime_error& failed) { return client::bad_input(failed.what(), ""); }

}  // namespace collided
