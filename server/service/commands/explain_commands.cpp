#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "idl/answers/explanation.hpp"
#include "idl/described_json.hpp"
#include "server/service/commands/measuring_commands.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/explain/event_explanation.hpp"
#include "server/world/query/nearest_approach.hpp"
#include "server/world/query/why_not_meeting.hpp"

// Engine and service fill the structs of idl/answers/explanation.hpp; their field lists write the answers.
namespace collided::engine::service {

using nlohmann::json;
using std::chrono::nanoseconds;

namespace {

/// An explanation examines the two tens to thousands of times, mostly at far fewer than all of their parts.
constexpr double kLooksAtAll = 20;
/// Each of the nearest misses needs a distance, about as costly as a pair; boxes separate most objects.
constexpr double kObjectsPerCost = 100;
/// About as costly as a group's clearance of a thousand objects; it runs on the thread for costly pairs in any case.
constexpr double kStandingCost = 10'000;
/// Two states of the past, and two reports on the pair.
constexpr double kEventCostPerObject = 1.0 / 50;
constexpr double kEventCost = 100;
constexpr std::size_t kLastEvents = 10;

ExplainedApproach told_approach(const NearestApproach& nearest) {
  return {.end = nearest.end,
          .from = nanoseconds(nearest.from_ns),
          .to = nanoseconds(nearest.to_ns),
          .time = nanoseconds(nearest.time_ns),
          .distance_m = nearest.distance_m,
          .error_m = nearest.error_m,
          .at_least_m = nearest.at_least_m,
          .looks = nearest.looks};
}

/// The name of the one that moves along with the other; empty if neither does.
std::string attached_of(const Snapshot& state, ObjectId a, ObjectId b) {
  if (!state.parents) return {};
  for (const auto& [child, parent] : {std::pair(a, b), std::pair(b, a)}) {
    const auto found = state.parents->find(child);
    if (found != state.parents->end() && found->second == parent) return state.objects[slot_of(child)]->name;
  }
  return {};
}

/// The ray's seven numbers; throws BadCommand if they are invalid.
std::array<double, kRayNumbers> ray_numbers(const Arguments& arguments) {
  const std::vector<double> list = arguments.numbers("ray");
  if (list.size() != 6) throw BadCommand(fmt::format("explain: 'ray' has {} numbers; 6 are needed", list.size()));
  std::array<double, kRayNumbers> numbers{};
  std::copy(list.begin(), list.end(), numbers.begin());
  numbers[6] = arguments.number("length");
  if (!is_question(QuestionKind::ray, numbers.data()))
    throw BadCommand("explain: the ray's direction is 0 0 0 or its length below 0");
  return numbers;
}

ExplainedNews news_of(const RecentEvent& recent, bool is_of_nearest) {
  const bool is_begin = recent.event.kind == EventKind::began;
  const char* const came = recent.event.joins_next ? "cross" : "enter";
  return {.sequence = recent.event.sequence,
          .what = is_of_nearest ? (is_begin ? "nearest" : "no longer nearest") : (is_begin ? came : "exit"),
          .object = recent.a,
          .why = std::string(name_of(recent.event.reason)),
          .doubt = std::string(name_of(recent.event.of.doubt)),
          .low = nanoseconds(recent.low_ns()),
          .high = nanoseconds(recent.high_ns())};
}

}  // namespace

/// The argument that is present selects what is explained: a standing question, a ray, an event, or the two of a pair.
void MeasuringCommands::explain_later(CommandAsk ask, const Arguments& arguments) {
  if (arguments.has("standing")) return explain_standing_later(std::move(ask));
  if (arguments.has("ray"))
    return in_turn(std::move(ask), arguments, "explain", &MeasuringCommands::asked_ray,
                   &MeasuringCommands::explained_ray);
  if (arguments.has("event"))
    return in_turn(std::move(ask), arguments, "explain", &MeasuringCommands::asked_event,
                   &MeasuringCommands::explained_event);
  static_cast<void>(arguments.whole("last_ns"));  // refuses a wrong one at once
  in_turn(std::move(ask), arguments, "explain", &MeasuringCommands::asked_explanation, &MeasuringCommands::explained);
}

// ---- two objects ---------------------------------------------------------------------------------------------------

MeasuringCommands::AskedPair MeasuringCommands::asked_explanation(const AwaitedJob& job) const {
  AskedPair asked = asked_pair(job);
  const Arguments arguments(job.ask.text);
  const std::uint64_t last_ns = arguments.whole("last_ns");
  asked.since_ns = last_ns == 0 ? std::numeric_limits<std::int64_t>::min()
                                : asked.state().world_time_ns - static_cast<std::int64_t>(last_ns);
  asked.cost *= kLooksAtAll;
  return asked;
}

json MeasuringCommands::explained(const AskedPair& asked) const {
  json answer = examined(asked);  // first, since the search for the least distance may take all of the time
  ExplainedPair told{.why_not = why_not_meeting(asked.state(), asked.a, asked.b),
                     .attached = attached_of(asked.state(), asked.a, asked.b)};
  const PoseMemory& memory = with_.loop.world().memory();
  std::optional<PoseMemory::RememberedPath> of_a = memory.path_of(asked.a);
  std::optional<PoseMemory::RememberedPath> of_b = memory.path_of(asked.b);
  if (of_a && of_b) {
    if (asked.past) {
      for (auto* path : {&*of_a, &*of_b}) path->to_ns = std::min(path->to_ns, asked.past->world_time_ns);
    }
    Deadline deadline(asked.options.deadline_ns, asked.options.called_off);
    told.nearest =
        told_approach(nearest_approach(asked.state(), asked.a, *of_a, asked.b, *of_b, asked.since_ns, deadline));
  } else {
    told.no_nearest = memory.is_on() ? "one of the two is not there any more" : "the server remembers no poses";
  }
  answer.update(json_of(told));
  return answer;
}

// ---- a ray ---------------------------------------------------------------------------------------------------------

/// Finds what the command names; throws BadCommand.
MeasuringCommands::AskedRay MeasuringCommands::asked_ray(const AwaitedJob& job) const {
  if (threads_.are_stopping()) throw BadCommand("the server is stopping");
  const Arguments arguments(job.ask.text);
  AskedRay asked{{.newest = with_.loop.world().newest()}};
  asked.past = past_state(arguments, *asked.newest);
  asked.options.numbers = ray_numbers(arguments);
  asked.options.mask = arguments.whole_32("mask");
  asked.options.only = arguments.text("only");
  asked.options.skip = arguments.text("skip");
  asked.options.most_misses = arguments.whole("most");
  if (const std::string name = arguments.text("why_not"); !name.empty())
    asked.options.why_not = find_shown(asked.state(), name);
  asked.deadline_ns = job.deadline_ns;
  asked.called_off = &job.called_off;
  asked.cost = static_cast<double>(asked.state().objects.size()) / kObjectsPerCost;
  for (const auto& scene : asked.state().scenes) asked.cost += static_cast<double>(scene->mesh.triangles.size());
  return asked;
}

json MeasuringCommands::explained_ray(const AskedRay& asked) const {
  Deadline deadline(asked.deadline_ns, asked.called_off);
  return json_of(explain_ray(asked.state(), asked.options, with_.part_meshes, deadline));
}

// ---- a standing question -------------------------------------------------------------------------------------------

/// The world's thread reads what it holds; distances and depths are computed on the thread for costly pairs.
void MeasuringCommands::explain_standing_later(CommandAsk ask) {
  const auto shared = std::make_shared<CommandAsk>(std::move(ask));
  if (!with_.inbox.push_job([this, shared] { explain_standing_of(*shared); }))
    answers_.refuse(*shared, "too many commands wait already", "ask again");
}

void MeasuringCommands::explain_standing_of(const CommandAsk& ask) {
  try {
    const Arguments arguments(ask.text);
    const std::string name = arguments.text("standing");
    const Fences* fences = with_.loop.world().fences();
    const auto look = std::make_shared<std::optional<StandingLook>>();
    if (fences != nullptr) *look = look_at_standing(*fences, name);
    if (!*look && fences != nullptr && fences->margins().contains(name))
      throw BadCommand(fmt::format("{} is a margin, of which each pair is explained", printable(name)),
                       "collide explain pair A B");
    if (!*look)
      throw BadCommand(fmt::format("no standing question {}", printable(name)), "collide fence ls, collide nearest ls");
    const auto job = await(ask, arguments);
    threads_.push_costly("explain", {.client = ask.client, .cost = kStandingCost}, [this, job, look] {
      if (!is_wanted(*job)) return;
      answers_.answer(job->ask, [&] { return finished(*job, [&] { return explained_standing(**look, *job); }); });
    });
  } catch (const BadCommand& bad) { answers_.refuse(ask, bad); }
}

json MeasuringCommands::explained_standing(const StandingLook& look, const AwaitedJob& job) const {
  if (threads_.are_stopping()) throw BadCommand("the server is stopping");
  const Arguments arguments(job.ask.text);
  const SnapshotRing::Lease state = with_.loop.world().newest();
  StandingExplanationAsk ask{.most_others = arguments.whole("most")};
  if (const std::string name = arguments.text("why_not"); !name.empty()) ask.why_not = find_shown(*state, name);
  Deadline deadline(job.deadline_ns, &job.called_off);
  ExplainedStanding explained = explain_standing(*state, look, ask, with_.part_meshes, deadline);
  for (const RecentEvent& event : with_.loop.recent_standing().last_of(look.id, kLastEvents))
    explained.events.push_back(news_of(event, look.rule.nearest.has_value()));
  return json_of(explained);
}

// ---- an event ------------------------------------------------------------------------------------------------------

/// Finds what the command names; throws BadCommand.
MeasuringCommands::AskedEvent MeasuringCommands::asked_event(const AwaitedJob& job) const {
  if (threads_.are_stopping()) throw BadCommand("the server is stopping");
  const Arguments arguments(job.ask.text);
  const std::string of = arguments.text("of", "contacts");
  if (of != "contacts" && of != "standing")
    throw BadCommand(fmt::format("explain: 'of' is {}; allowed: contacts, standing", printable(of)));
  const bool is_of_fence = of == "standing";
  const RecentEvents& events = is_of_fence ? with_.loop.recent_standing() : with_.loop.recent_contacts();
  const std::uint64_t sequence = arguments.whole("event");
  std::optional<RecentEvent> recent = events.find(sequence);
  if (!recent) {
    const RecentEvents::SequenceSpan span = events.span();
    const char* const what = is_of_fence ? "standing questions" : "contacts";
    throw BadCommand(
        span.last == 0 ? fmt::format("no event {}: there was none of {} so far", sequence, what)
                       : fmt::format("no event {}: those of {} from {} to {} are remembered", sequence, what,
                                     span.first, span.last),
        is_of_fence ? "" : "collide explain event SEQ --of standing asks about one of a standing question");
  }
  const double objects = static_cast<double>(with_.loop.world().newest()->objects.size());
  return {.recent = std::move(*recent),
          .is_of_fence = is_of_fence,
          .deadline_ns = job.deadline_ns,
          .called_off = &job.called_off,
          .cost = kEventCost + kEventCostPerObject * objects};
}

json MeasuringCommands::explained_event(const AskedEvent& asked) const {
  Deadline deadline(asked.deadline_ns, asked.called_off);
  const auto name_of = [&](std::uint64_t publisher) { return with_.loop.publisher_name(publisher); };
  ExplainedEvent told = explain_event(with_.loop.world().memory(), asked.recent, asked.is_of_fence,
                                      with_.clock_error_ns, name_of, deadline);
  told.version = with_.loop.world().newest()->version;
  return json_of(told);
}

}  // namespace collided::engine::service
