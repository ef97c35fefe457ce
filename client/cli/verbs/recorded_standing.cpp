#include "client/cli/verbs/recorded_standing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include <collided/recording.hpp>

#include "client/cli/command.hpp"
#include "client/cli/output/event_output.hpp"

namespace collided::cli {
namespace {

using std::chrono::nanoseconds;

/// As many as a running server tells of.
constexpr std::size_t kLastEvents = 10;

/// What happened up to then, or what held then.
RecordedFenceEvents news_up_to(const std::string& path, nanoseconds instant) {
  RecordedEventsOptions options;
  options.to = RunTime{.offset = instant};
  return take(recorded_fence_events(path, options));
}
RecordedFenceEvents held_at(const std::string& path, nanoseconds instant) {
  // What happened at the instant itself held from then on.
  const RunTime after{.offset = instant + nanoseconds(instant < nanoseconds::max() ? 1 : 0)};
  RecordedEventsOptions options;
  options.from = options.to = after;
  return take(recorded_fence_events(path, options));
}

/// World time that lies so many seconds before the event's.
template <class OneEvent>
nanoseconds before(const OneEvent& event, double seconds) {
  return event.world_time - nanoseconds(std::llround(seconds * 1e9));
}

void put_told(ExplainedStanding& standing, nanoseconds since, Doubt doubt, std::uint64_t episode) {
  standing.told = true;
  standing.since = since;
  standing.doubt = std::string(name_of(doubt));
  standing.episode = episode;
}
void forget_told(ExplainedStanding& standing) {
  standing.told = false;
  standing.since.reset();
  standing.doubt.clear();
  standing.episode = 0;
}

void put_last(std::vector<ExplainedNews> news, std::vector<ExplainedNews>& events) {
  if (news.size() > kLastEvents) news.erase(news.begin(), news.end() - static_cast<std::ptrdiff_t>(kLastEvents));
  events = std::move(news);
}

ExplainedNews news_of(const FenceEvent& event) {
  const bool is_cross = event.kind == FenceEventKind::cross;
  const bool is_exit = event.kind == FenceEventKind::exit;
  return {.sequence = event.sequence,
          .what = is_cross  ? "cross"
                  : is_exit ? "exit"
                            : "enter",
          .object = event.object,
          .why = std::string(name_of(event.reason)),
          .doubt = std::string(name_of(event.doubt)),
          .low = before(event, event.bracket_low_s),
          .high = before(event, is_cross ? event.left_high_s : event.bracket_high_s)};
}

ExplainedNews news_of(const NearestEvent& event) {
  const bool is_any = !event.to.empty();
  return {.sequence = event.sequence,
          .what = is_any ? "nearest" : "no longer nearest",
          .object = is_any ? event.to : event.from,
          .why = is_any ? std::string() : std::string(name_of(event.reason)),
          .doubt = std::string(name_of(event.doubt)),
          .low = before(event, event.bracket_low_s),
          .high = before(event, event.bracket_high_s)};
}

/// Makes this object the one that is nearest, and the one that was one of the others.
void make_nearest(ExplainedNearest& told, const std::string& object) {
  if (told.is && told.is->object == object) return;
  std::vector<ExplainedStanding>& others = told.others;
  if (told.is) others.push_back(*std::exchange(told.is, std::nullopt));
  const auto found = std::ranges::find(others, object, &ExplainedStanding::object);
  if (found != others.end()) {
    told.is = std::move(*found);
    others.erase(found);
  }
  std::ranges::stable_sort(others, {}, &ExplainedStanding::clearance_m);
}

}  // namespace

void put_recorded_news(ExplainedFence& told, const std::string& path, nanoseconds instant) {
  std::map<std::string, FenceEvent> inside;
  for (FenceEvent& event : held_at(path, instant).fences) {
    if (event.fence == told.fence) inside.emplace(event.object, std::move(event));
  }
  const auto put = [&](ExplainedStanding& standing) {
    forget_told(standing);
    const auto found = inside.find(standing.object);
    if (found == inside.end()) return;
    const FenceEvent& event = found->second;
    put_told(standing, event.entered, event.doubt, event.episode);
  };
  for (auto* list : {&told.inside, &told.outside, &told.left_out}) std::ranges::for_each(*list, put);
  if (told.asked_for) put(*told.asked_for);
  std::vector<ExplainedNews> news;
  for (const FenceEvent& event : news_up_to(path, instant).fences) {
    if (event.fence == told.fence && event.kind != FenceEventKind::inside) news.push_back(news_of(event));
  }
  put_last(std::move(news), told.events);
}

void put_recorded_news(ExplainedNearest& told, const std::string& path, nanoseconds instant, std::size_t most) {
  std::string object;
  Doubt doubt = Doubt::none;
  for (const NearestEvent& event : held_at(path, instant).nearest) {
    if (event.nearest != told.nearest) continue;
    object = event.to;
    doubt = event.doubt;
  }
  make_nearest(told, object);
  std::optional<nanoseconds> since;
  std::vector<ExplainedNews> news;
  for (const NearestEvent& event : news_up_to(path, instant).nearest) {
    if (event.nearest != told.nearest || event.kind == NearestEventKind::is) continue;
    news.push_back(news_of(event));
    if (!event.to.empty()) since = before(event, event.bracket_high_s);
  }
  const auto put = [&](ExplainedStanding& standing) {
    forget_told(standing);
    if (since && standing.object == object) put_told(standing, *since, doubt, 0);
  };
  for (auto* list : {&told.others, &told.left_out}) std::ranges::for_each(*list, put);
  for (auto* one : {&told.is, &told.asked_for}) {
    if (*one) put(**one);
  }
  if (told.others.size() > most) told.others.resize(most);
  put_last(std::move(news), told.events);
  told.cut_short = 0;  // of the replay's searches
}

}  // namespace collided::cli
