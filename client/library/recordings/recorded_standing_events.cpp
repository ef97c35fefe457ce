#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "client/library/connection/errors.hpp"
#include "client/library/recordings/recorded_events.hpp"
#include "client/library/watching/standing_news.hpp"
#include "collided/recording.hpp"

namespace collided {
namespace {

void warn_of(const client::MissingEvents& missing, const std::string& path, std::vector<std::string>& warnings) {
  const auto warn = [&](const std::string& what) { warnings.push_back(path + ": " + what); };
  if (missing.lost > 0)
    warn(std::to_string(missing.lost) +
         " events of standing questions are not in it; what they changed is marked resync as far as it shows");
  if (missing.undated > 0)
    warn("of " + std::to_string(missing.undated) +
         " that held at its begin it has the end but not since when: at least from its begin");
  if (missing.is_begin_doubtful) warn("it does not say all that standing questions held at its begin");
}

}  // namespace

Result<RecordedStandingEvents> recorded_standing_events(const std::string& path,
                                                        const RecordedEventsOptions& options) try {
  const client::RecordedItems recorded = client::read_items(client::read_recording(path), path, "Nothing was read");
  const client::RecordedSpan span = client::span_of(recorded);
  const auto from = options.from ? client::resolved(*options.from, span) : std::chrono::nanoseconds::min();
  const auto to = options.to ? client::resolved(*options.to, span) : std::chrono::nanoseconds::max();
  if (from > to) return client::bad_input("the end of what is asked for lies before its begin", "nothing was read");
  std::vector<client::StandingNews> heard;
  client::Names names;
  client::WatchStateOf<client::StandingNews> watch([&](const client::StandingNews& news) { heard.push_back(news); });
  const client::MissingEvents missing = client::hear_recording(recorded, names, watch);
  RecordedStandingEvents read{
      .events = {}, .begin = span.begin, .end = span.end, .lost = missing.lost, .warnings = recorded.warnings};
  for (const client::StandingNews& news : client::in_window(std::move(heard), from, to, client::EventOrder::sequence)) {
    std::optional<StandingEvent> one = client::event_of(news);
    if (one && client::is_wanted(*one, {.only = options.only, .skip = options.skip}))
      read.events.push_back(std::move(*one));
  }
  warn_of(missing, path, read.warnings);
  return read;
} catch (const std::runtime_error& failed) { return client::bad_input(failed.what(), ""); }

}  // namespace collided
