#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "server/service/commands/awaited_jobs-inl.hpp"
#include "server/service/commands/certificate_encoding.hpp"
#include "server/service/commands/commands.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/world/query/nearest_approach.hpp"
#include "server/world/query/why_not_meeting.hpp"

namespace collided::engine::service {

using nlohmann::json;

namespace {

/// An explanation looks at the two some tens to thousands of times, mostly at far fewer than all of their parts.
constexpr double kLooksAtAll = 20;

json described(const NearestApproach& nearest) {
  static constexpr const char* kEnds[] = {"found", "touched", "undecided", "cut_short"};
  return {{"end", kEnds[static_cast<std::size_t>(nearest.end)]},
          {"from_ns", nearest.from_ns},
          {"to_ns", nearest.to_ns},
          {"time_ns", nearest.time_ns},
          {"distance", number_or_inf(nearest.distance_m)},
          {"error", number_or_inf(nearest.error_m)},
          {"at_least", number_or_inf(nearest.at_least_m)},
          {"looks", nearest.looks}};
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

}  // namespace

Commands::AskedPair Commands::asked_explanation(const AwaitedJob& job) const {
  AskedPair asked = asked_pair(job);
  const Arguments arguments(job.ask.text);
  const std::uint64_t last_ns = arguments.whole("last_ns", 0, std::uint64_t{1} << 62);
  asked.since_ns = last_ns == 0 ? std::numeric_limits<std::int64_t>::min()
                                : asked.state().world_time_ns - static_cast<std::int64_t>(last_ns);
  asked.cost *= kLooksAtAll;
  return asked;
}

json Commands::explained(const AskedPair& asked) const {
  json answer = examined(asked);
  answer["why_not"] = why_not_meeting(asked.state(), asked.a, asked.b);
  answer["attached"] = attached_of(asked.state(), asked.a, asked.b);
  const PoseMemory& memory = with_.loop.world().memory();
  std::optional<PoseMemory::RememberedPath> of_a = memory.path_of(asked.a);
  std::optional<PoseMemory::RememberedPath> of_b = memory.path_of(asked.b);
  if (!of_a || !of_b) {
    answer["no_nearest"] = memory.is_on() ? "one of the two is not there any more" : "the server remembers no poses";
    return answer;
  }
  if (asked.past) {
    for (auto* path : {&*of_a, &*of_b}) path->to_ns = std::min(path->to_ns, asked.past->world_time_ns);
  }
  Deadline deadline(asked.options.deadline_ns, asked.options.called_off);
  answer["nearest"] =
      described(nearest_approach(asked.state(), asked.a, *of_a, asked.b, *of_b, asked.since_ns, deadline));
  return answer;
}

/// What it is about is said by the argument that there is: a ray, a fence, a question for the nearest, an event, or the two of
/// a pair.
void Commands::explain_later(CommandAsk ask, const Arguments& arguments) {
  if (arguments.has("fence") || arguments.has("nearest")) return explain_fence_later(std::move(ask), arguments);
  if (arguments.has("ray")) {
    const auto check = [](const Arguments& given) {
      given.allow_only({"ray", "length", "only", "skip", "mask", "most", "why_not", "as_of", "deadline_ns"});
    };
    return in_turn(std::move(ask), arguments, "explain", check, &Commands::asked_ray, &Commands::explained_ray);
  }
  if (arguments.has("event")) {
    const auto check = [](const Arguments& given) { given.allow_only({"event", "of", "deadline_ns"}); };
    return in_turn(std::move(ask), arguments, "explain", check, &Commands::asked_event, &Commands::explained_event);
  }
  const auto check = [](const Arguments& given) {
    given.allow_only({"a", "b", "last_ns", "as_of", "deadline_ns"});
    static_cast<void>(given.whole("last_ns", 0, std::uint64_t{1} << 62));
  };
  in_turn(std::move(ask), arguments, "explain", check, &Commands::asked_explanation, &Commands::explained);
}

}  // namespace collided::engine::service
