#include "client/cli/verbs/recorded_standing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <utility>

#include <collided/recording.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.hpp"
#include "client/cli/output/event_output.hpp"
#include "client/cli/output/explanation_output.hpp"

namespace collided::cli {
namespace {

using nlohmann::json;
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
std::int64_t before(const OneEvent& event, double seconds) {
  return event.world_time.count() - std::llround(seconds * 1e9);
}

void put_told(json& row, std::int64_t since_ns, Doubt doubt) {
  row["told"] = true;
  row["since_ns"] = since_ns;
  row["doubt"] = name_of(doubt);
}

/// Calls visit(row) for every object that the answer tells of.
template <class Visit>
void for_each_standing(json& answer, std::initializer_list<const char*> lists, const Visit& visit) {
  for (const char* list : lists) {
    for (json& row : answer.at(list)) visit(row);
  }
  if (answer.contains("asked_for")) visit(answer.at("asked_for"));
}

void forget_told(json& row) {
  for (const char* key : {"told", "since_ns", "episode", "doubt"}) row.erase(key);
}

json last_of(json rows) {
  if (rows.size() > kLastEvents) rows.erase(rows.begin(), rows.end() - static_cast<std::ptrdiff_t>(kLastEvents));
  return rows;
}

json event_row(const FenceEvent& event) {
  const bool is_cross = event.kind == FenceEventKind::cross;
  const bool is_exit = event.kind == FenceEventKind::exit;
  return {{"sequence", event.sequence},
          {"what", is_cross  ? "cross"
                   : is_exit ? "exit"
                             : "enter"},
          {"object", event.object},
          {"why", name_of(event.reason)},
          {"doubt", name_of(event.doubt)},
          {"low_ns", before(event, event.bracket_low_s)},
          {"high_ns", before(event, is_cross ? event.left_high_s : event.bracket_high_s)}};
}

json event_row(const NearestEvent& event) {
  const bool is_any = !event.to.empty();
  return {{"sequence", event.sequence},
          {"what", is_any ? "nearest" : "no longer nearest"},
          {"object", is_any ? event.to : event.from},
          {"why", is_any ? "" : name_of(event.reason)},
          {"doubt", name_of(event.doubt)},
          {"low_ns", before(event, event.bracket_low_s)},
          {"high_ns", before(event, event.bracket_high_s)}};
}

/// Makes this object the one that is nearest in the answer, and the one there one of the others.
void make_nearest(json& answer, const std::string& object) {
  json& is = answer.at("is");
  json& others = answer.at("others");
  if (!is.empty() && is.front().at("object") == object) return;
  for (json& row : is) others.push_back(std::move(row));
  is = json::array();
  const auto found =
      std::find_if(others.begin(), others.end(), [&](const json& row) { return row.at("object") == object; });
  if (found != others.end()) {
    is.push_back(std::move(*found));
    others.erase(found);
  }
  std::stable_sort(others.begin(), others.end(), [](const json& a, const json& b) {
    return number_or_inf(a, "clearance") < number_or_inf(b, "clearance");
  });
}

}  // namespace

void put_recorded_news_of_fence(json& answer, const std::string& path, nanoseconds instant) {
  const std::string name = answer.at("fence");
  std::map<std::string, FenceEvent> inside;
  for (FenceEvent& event : held_at(path, instant).fences) {
    if (event.fence == name) inside.emplace(event.object, std::move(event));
  }
  for_each_standing(answer, {"inside", "outside", "left_out"}, [&](json& row) {
    forget_told(row);
    const auto told = inside.find(row.at("object").get<std::string>());
    if (told == inside.end()) return;
    put_told(row, told->second.entered.count(), told->second.doubt);
    row["episode"] = told->second.episode;
  });
  json events = json::array();
  for (const FenceEvent& event : news_up_to(path, instant).fences) {
    if (event.fence == name && event.kind != FenceEventKind::inside) events.push_back(event_row(event));
  }
  answer["events"] = last_of(std::move(events));
}

void put_recorded_news_of_nearest(json& answer, const std::string& path, nanoseconds instant, std::size_t most) {
  const std::string name = answer.at("nearest");
  std::string object;
  Doubt doubt = Doubt::none;
  for (const NearestEvent& event : held_at(path, instant).nearest) {
    if (event.nearest != name) continue;
    object = event.to;
    doubt = event.doubt;
  }
  make_nearest(answer, object);
  std::optional<std::int64_t> since_ns;
  json events = json::array();
  for (const NearestEvent& event : news_up_to(path, instant).nearest) {
    if (event.nearest != name || event.kind == NearestEventKind::is) continue;
    events.push_back(event_row(event));
    if (!event.to.empty()) since_ns = before(event, event.bracket_high_s);
  }
  for_each_standing(answer, {"is", "others", "left_out"}, [&](json& row) {
    forget_told(row);
    if (since_ns && row.at("object") == object) put_told(row, *since_ns, doubt);
  });
  json& others = answer.at("others");
  if (others.size() > most) others.erase(others.begin() + static_cast<std::ptrdiff_t>(most), others.end());
  answer["events"] = last_of(std::move(events));
  answer.erase("cut_short");  // of the replay's searches
}

}  // namespace collided::cli
