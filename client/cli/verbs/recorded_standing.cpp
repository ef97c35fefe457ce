#include "client/cli/verbs/recorded_standing.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include <collided/recording.hpp>

#include "client/cli/command.hpp"
#include "client/cli/output/event_output.hpp"

namespace collided::cli {
namespace {

using std::chrono::nanoseconds;
using Kind = StandingEventKind;

/// As many as a running server reports.
constexpr std::size_t kLastEvents = 10;

/// The events of the question of that name.
std::vector<StandingEvent> events_of(const std::string& name, const std::string& path,
                                     const RecordedEventsOptions& options) {
  std::vector<StandingEvent> events = take(recorded_standing_events(path, options)).events;
  std::erase_if(events, [&](const StandingEvent& event) { return event.standing != name; });
  return events;
}

bool held_before(const StandingEvent& event) { return event.kind == Kind::inside || event.kind == Kind::is; }

/// The held objects at an instant, by name.
std::map<std::string, StandingEvent> held_at(const std::string& name, const std::string& path, nanoseconds instant) {
  // Changes at the instant itself hold from then on.
  const RunTime after{.offset = instant + nanoseconds(instant < nanoseconds::max() ? 1 : 0)};
  RecordedEventsOptions options;
  options.from = options.to = after;
  std::map<std::string, StandingEvent> held;
  for (StandingEvent& event : events_of(name, path, options)) {
    std::string object = event.object;
    if (held_before(event)) held.emplace(std::move(object), std::move(event));
  }
  return held;
}

/// The world time this many seconds before the event's.
nanoseconds before(const StandingEvent& event, double seconds) {
  return event.world_time - nanoseconds(std::llround(seconds * 1e9));
}

ExplainedNews news_of(const StandingEvent& event) {
  const bool is_of_nearest = event.form == StandingForm::nearest;
  const bool is_over = is_of_nearest && event.object.empty();
  const bool is_reason_shown = is_over || event.kind == Kind::exit;
  return {.sequence = event.sequence,
          .what = std::string(!is_of_nearest ? name_of(event.kind)
                              : is_over      ? "no longer nearest"
                                             : "nearest"),
          .object = is_over ? event.other : event.object,
          .why = std::string(is_reason_shown ? name_of(event.reason) : ""),
          .doubt = std::string(name_of(event.doubt)),
          .low = before(event, event.bracket_low_s),
          .high = before(event, event.kind == Kind::cross ? event.left_high_s : event.bracket_high_s)};
}

/// The last events up to the instant, without those that report earlier states.
std::vector<ExplainedNews> news_up_to(const std::string& name, const std::string& path, nanoseconds instant) {
  RecordedEventsOptions options;
  options.to = RunTime{.offset = instant};
  std::vector<ExplainedNews> news;
  for (const StandingEvent& event : events_of(name, path, options)) {
    if (!held_before(event)) news.push_back(news_of(event));
  }
  if (news.size() > kLastEvents) news.erase(news.begin(), news.end() - static_cast<std::ptrdiff_t>(kLastEvents));
  return news;
}

/// Makes this object the nearest, and the previous one one of the others. An empty name: none is nearest.
void make_nearest(ExplainedStanding& explained, const std::string& object) {
  if (!explained.holds.empty() && explained.holds.front().object == object) return;
  std::vector<ExplainedObject>& others = explained.others;
  std::ranges::move(std::exchange(explained.holds, {}), std::back_inserter(others));
  if (const auto found = std::ranges::find(others, object, &ExplainedObject::object); found != others.end()) {
    explained.holds.push_back(std::move(*found));
    others.erase(found);
  }
  std::ranges::stable_sort(others, {}, &ExplainedObject::clearance_m);
}

}  // namespace

void put_recorded_news(ExplainedStanding& explained, const std::string& path, nanoseconds instant, std::size_t most) {
  const std::map<std::string, StandingEvent> held = held_at(explained.name, path, instant);
  if (explained.form == StandingForm::nearest) make_nearest(explained, held.empty() ? "" : held.begin()->first);
  const auto put = [&](ExplainedObject& object) {
    const auto found = held.find(object.object);
    object.reported = found != held.end();
    object.since.reset();
    object.doubt.clear();
    object.episode = 0;
    if (!object.reported) return;
    object.since = found->second.entered;
    object.doubt = std::string(name_of(found->second.doubt));
    object.episode = found->second.episode;
  };
  for (auto* list : {&explained.holds, &explained.others, &explained.left_out}) std::ranges::for_each(*list, put);
  if (explained.asked_for) put(*explained.asked_for);
  if (explained.others.size() > most) explained.others.resize(most);
  explained.events = news_up_to(explained.name, path, instant);
  explained.cut_short = 0;  // the replay's searches
}

}  // namespace collided::cli
