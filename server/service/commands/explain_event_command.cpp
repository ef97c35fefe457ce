#include <fmt/format.h>

#include "server/service/commands/awaited_jobs-inl.hpp"
#include "server/service/commands/certificate_encoding.hpp"
#include "server/service/commands/commands.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/explain/event_explanation.hpp"

namespace collided::engine::service {

using nlohmann::json;

namespace {

/// Two states of the past, and two reports on the pair.
constexpr double kEventCostPerObject = 1.0 / 50;
constexpr double kEventCost = 100;

const char* word_of_kind(EventKind kind, bool is_of_fence, ObjectId fence) {
  static constexpr const char* kContacts[] = {"began", "persisted", "ended", "contained", "emerged"};
  if (is_nearest_question(fence)) return kind == EventKind::began ? "nearest" : "no longer nearest";
  if (is_of_fence) return kind == EventKind::began ? "enter" : "exit";
  return kContacts[static_cast<std::size_t>(kind)];
}

json described(const EventGap& gap) {
  static constexpr const char* kWords[] = {"apart", "touching", "undecided"};
  return {{"time_ns", gap.time_ns},
          {"answer", kWords[static_cast<std::size_t>(gap.touches)]},
          {"clearance", gap.distance_m + 0.0},
          {"error", number_or_inf(gap.error_m)}};
}

json described(const EventBody& body, const std::string& publisher_name) {
  json row{{"object", body.name}, {"remembered", body.is_remembered}};
  if (!body.is_remembered) return row;
  row["moving"] = body.moves;
  row["publisher"] = publisher_name;
  row["pose"] = numbers(body.pose.position);
  for (const json& number : numbers(body.pose.rotation)) row["pose"].push_back(number);
  if (body.motion) {
    row["motion_from_ns"] = body.motion->from_ns;
    row["motion_to_ns"] = body.motion->to_ns;
  }
  return row;
}

/// What the event itself said. A band's fence has its margin, object and distance in its name, a line each.
json described(const RecentEvent& recent, bool is_of_fence) {
  const Event& event = recent.event;
  json row{{"sequence", event.sequence},
           {"what", word_of_kind(event.kind, is_of_fence, event.of.b)},
           {"why", name_of(event.reason)},
           {"doubt", name_of(event.of.doubt)},
           {"a", recent.a},
           {"b", recent.b},
           {"a_triangle", event.of.a_triangle},
           {"b_triangle", event.of.b_triangle},
           {"episode", event.of.episode},
           {"began_ns", event.of.began_ns},
           {"depth", event.of.contact.depth_m + 0.0},
           {"error", number_or_inf(event.of.contact.depth_error_m)},
           {"point", numbers(event.of.contact.point)},
           {"normal", numbers(event.of.contact.normal)},
           {"world_time_ns", recent.world_time_ns},
           {"low_ns", recent.low_ns()},
           {"high_ns", recent.high_ns()}};
  if (const std::size_t line = recent.b.find('\n'); line != std::string::npos) {
    row["margin"] = recent.b.substr(0, line);
    const std::size_t next = recent.b.find('\n', line + 1);
    row["b"] = recent.b.substr(line + 1, next - line - 1);
    row["within"] = recent.b.substr(recent.b.rfind('\n') + 1);
  }
  return row;
}

}  // namespace

/// Finds what the command names; throws BadCommand.
Commands::AskedEvent Commands::asked_event(const AwaitedJob& job) const {
  if (stopping_.load()) throw BadCommand("the server is stopping");
  const Arguments arguments(job.ask.text);
  const std::string of = arguments.text("of", "contacts");
  if (of != "contacts" && of != "fences")
    throw BadCommand(fmt::format("explain: 'of' is {}; allowed: contacts, fences", printable(of)));
  const bool is_of_fence = of == "fences";
  const RecentEvents& events = with_.loop.recent_events(is_of_fence ? BroadcastOf::fences : BroadcastOf::contacts);
  const std::uint64_t sequence = arguments.whole("event", 0, ~std::uint64_t{0});
  std::optional<RecentEvent> recent = events.find(sequence);
  if (!recent) {
    const RecentEvents::SequenceSpan span = events.span();
    throw BadCommand(span.last == 0 ? fmt::format("no event {}: there was none of {} so far", sequence, of)
                                    : fmt::format("no event {}: those of {} from {} to {} are remembered", sequence, of,
                                                  span.first, span.last),
                     is_of_fence ? "" : "collide explain event SEQ --of fences asks about one of a fence");
  }
  const double objects = static_cast<double>(with_.loop.world().newest()->objects.size());
  return {.recent = std::move(*recent),
          .is_of_fence = is_of_fence,
          .deadline_ns = job.deadline_ns,
          .called_off = &job.called_off,
          .cost = kEventCost + kEventCostPerObject * objects};
}

json Commands::explained_event(const AskedEvent& asked) const {
  Deadline deadline(asked.deadline_ns, asked.called_off);
  const EventExplanation told =
      explain_event(with_.loop.world().memory(), asked.recent, asked.is_of_fence, with_.clock_error_ns, deadline);
  json answer = described(asked.recent, asked.is_of_fence);
  answer["of"] = asked.is_of_fence ? "fences" : "contacts";
  answer["bodies"] = json::array();
  for (const EventBody& body : told.bodies)
    answer["bodies"].push_back(described(body, with_.loop.publisher_name(body.publisher)));
  if (told.before) answer["before"] = described(*told.before);
  if (told.after) answer["after"] = described(*told.after);
  answer["why_wide"] = told.why_wide;
  answer["version"] = with_.loop.world().newest()->version;
  return answer;
}

}  // namespace collided::engine::service
