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

// Engine and service fill the structs of idl/answers/explanation.hpp; their lists of fields write the answers.
namespace collided::engine::service {

using nlohmann::json;
using std::chrono::nanoseconds;

namespace {

/// An explanation looks at the two some tens to thousands of times, mostly at far fewer than all of their parts.
constexpr double kLooksAtAll = 20;
/// A distance for each of the nearest misses, each about as a pair; most objects are told apart by their boxes.
constexpr double kObjectsPerCost = 100;
/// About as a group's clearance of a thousand objects; the thread for costly pairs has it in any case.
constexpr double kFenceCost = 10'000;
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

/// The name of the one of the two that moves along with the other; empty where neither does.
std::string attached_of(const Snapshot& state, ObjectId a, ObjectId b) {
  if (!state.parents) return {};
  for (const auto& [child, parent] : {std::pair(a, b), std::pair(b, a)}) {
    const auto found = state.parents->find(child);
    if (found != state.parents->end() && found->second == parent) return state.objects[slot_of(child)]->name;
  }
  return {};
}

/// The ray's seven numbers; throws BadCommand where they are none.
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

ExplainedNews told_news(const RecentEvent& recent, bool is_of_nearest) {
  const bool is_begin = recent.event.kind == EventKind::began;
  return {.sequence = recent.event.sequence,
          .what = is_of_nearest ? (is_begin ? "nearest" : "no longer nearest") : (is_begin ? "enter" : "exit"),
          .object = recent.a,
          .why = std::string(name_of(recent.event.reason)),
          .doubt = std::string(name_of(recent.event.of.doubt)),
          .low = nanoseconds(recent.low_ns()),
          .high = nanoseconds(recent.high_ns())};
}

/// A question for the nearest, by what was found out of it as of a fence.
ExplainedNearest as_nearest(ExplainedFence told, const FenceLook& look) {
  ExplainedNearest nearest{.nearest = std::move(told.fence),
                           .to = std::move(told.to),
                           .only = std::move(told.only),
                           .skip = std::move(told.skip),
                           .mask = told.mask,
                           .within_m = look.rule.nearest->within_m,
                           .hysteresis_m = look.rule.nearest->hysteresis_m,
                           .keep = told.keep,
                           .placed = told.placed,
                           .looked_at = told.looked_at,
                           .others = std::move(told.outside),
                           .left_out = std::move(told.left_out),
                           .asked_for = std::move(told.asked_for),
                           .events = std::move(told.events),
                           .cut_short = look.cut_short,
                           .late = told.late,
                           .world_time = told.world_time,
                           .version = told.version};
  if (look.rule.carrier.empty()) nearest.point = std::get<Sphere>(look.body.primitives.front()).center;
  if (!told.inside.empty()) nearest.is = std::move(told.inside.front());
  return nearest;
}

}  // namespace

/// What it is about is said by the argument that there is: a ray, a fence, a question for the nearest, an event, or the two of
/// a pair.
void MeasuringCommands::explain_later(CommandAsk ask, const Arguments& arguments) {
  if (arguments.has("fence") || arguments.has("nearest")) return explain_fence_later(std::move(ask));
  if (arguments.has("ray"))
    return in_turn(std::move(ask), arguments, "explain", &MeasuringCommands::asked_ray,
                   &MeasuringCommands::explained_ray);
  if (arguments.has("event"))
    return in_turn(std::move(ask), arguments, "explain", &MeasuringCommands::asked_event,
                   &MeasuringCommands::explained_event);
  static_cast<void>(arguments.whole("last_ns"));  // a wrong one is refused at once
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

// ---- a fence, and the nearest --------------------------------------------------------------------------------------

/// The world's thread says who is in the fence; how far in is worked out on the thread for costly pairs.
void MeasuringCommands::explain_fence_later(CommandAsk ask) {
  const auto shared = std::make_shared<CommandAsk>(std::move(ask));
  if (!with_.inbox.push_job([this, shared] { explain_fence_of(*shared); }))
    answers_.refuse(*shared, "too many commands wait already", "ask again");
}

void MeasuringCommands::explain_fence_of(const CommandAsk& ask) {
  try {
    const Arguments arguments(ask.text);
    const bool is_fence = arguments.has("fence");
    const std::string name = arguments.text(is_fence ? "fence" : "nearest");
    const Fences* fences = with_.loop.world().fences();
    const auto look = std::make_shared<std::optional<FenceLook>>();
    if (fences != nullptr) *look = is_fence ? look_at_fence(*fences, name) : look_at_nearest(*fences, name);
    if (!*look && !is_fence) throw BadCommand(fmt::format("no question {}", printable(name)), "collide nearest ls");
    if (!*look && fences != nullptr && fences->margins().contains(name))
      throw BadCommand(fmt::format("{} is a margin, no fence", printable(name)), "collide margin ls");
    if (!*look) throw BadCommand(fmt::format("no fence {}", printable(name)), "collide fence ls");
    const auto job = await(ask, arguments);
    threads_.push_costly("explain", {.client = ask.client, .cost = kFenceCost}, [this, job, look] {
      if (!is_wanted(*job)) return;
      answers_.answer(job->ask, [&] { return finished(*job, [&] { return explained_fence(**look, *job); }); });
    });
  } catch (const BadCommand& bad) { answers_.refuse(ask, bad); }
}

json MeasuringCommands::explained_fence(const FenceLook& look, const AwaitedJob& job) const {
  if (threads_.are_stopping()) throw BadCommand("the server is stopping");
  const Arguments arguments(job.ask.text);
  const SnapshotRing::Lease state = with_.loop.world().newest();
  FenceExplanationAsk ask{.most_outside = arguments.whole("most")};
  if (const std::string name = arguments.text("why_not"); !name.empty()) ask.why_not = find_shown(*state, name);
  Deadline deadline(job.deadline_ns, &job.called_off);
  ExplainedFence told = explain_fence(*state, look, ask, with_.part_meshes, deadline);
  const bool is_of_nearest = look.rule.nearest.has_value();
  for (const RecentEvent& event : with_.loop.recent_events(BroadcastOf::fences).last_of(look.id, kLastEvents))
    told.events.push_back(told_news(event, is_of_nearest));
  return is_of_nearest ? json_of(as_nearest(std::move(told), look)) : json_of(told);
}

// ---- an event ------------------------------------------------------------------------------------------------------

/// Finds what the command names; throws BadCommand.
MeasuringCommands::AskedEvent MeasuringCommands::asked_event(const AwaitedJob& job) const {
  if (threads_.are_stopping()) throw BadCommand("the server is stopping");
  const Arguments arguments(job.ask.text);
  const std::string of = arguments.text("of", "contacts");
  if (of != "contacts" && of != "fences")
    throw BadCommand(fmt::format("explain: 'of' is {}; allowed: contacts, fences", printable(of)));
  const bool is_of_fence = of == "fences";
  const RecentEvents& events = with_.loop.recent_events(is_of_fence ? BroadcastOf::fences : BroadcastOf::contacts);
  const std::uint64_t sequence = arguments.whole("event");
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

json MeasuringCommands::explained_event(const AskedEvent& asked) const {
  Deadline deadline(asked.deadline_ns, asked.called_off);
  const auto name_of = [&](std::uint64_t publisher) { return with_.loop.publisher_name(publisher); };
  ExplainedEvent told = explain_event(with_.loop.world().memory(), asked.recent, asked.is_of_fence,
                                      with_.clock_error_ns, name_of, deadline);
  told.version = with_.loop.world().newest()->version;
  return json_of(told);
}

}  // namespace collided::engine::service
