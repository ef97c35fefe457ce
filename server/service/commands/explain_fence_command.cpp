#include <fmt/format.h>

#include "server/service/commands/commands.hpp"
#include "server/service/commands/certificate_encoding.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {

using nlohmann::json;
using wire_contract::ReplyStatus;

namespace {

constexpr std::size_t kLastEvents = 10;
/// About as a group's clearance of a thousand objects; the thread for costly pairs has it in any case.
constexpr double kFenceCost = 10'000;

json described(const FenceStanding& standing, const Snapshot& state) {
  static constexpr const char* kWords[] = {"outside", "inside", "undecided"};
  json row{{"object", state.objects[slot_of(standing.object)]->name},
           {"answer", kWords[static_cast<std::size_t>(standing.is_in)]},
           {"clearance", number_or_inf(standing.distance_m)},
           {"error", number_or_inf(standing.error_m)}};
  if (standing.is_in == Decision::no && standing.distance_m < std::numeric_limits<double>::infinity()) {
    row["on_fence"] = numbers(standing.on_fence);
    row["on_object"] = numbers(standing.on_object);
  }
  if (standing.is_stale) row["stale"] = true;
  if (!standing.why_not_looked_at.empty()) row["why"] = standing.why_not_looked_at;
  if (standing.told) {
    row["told"] = true;
    row["since_ns"] = standing.told->began_ns;
    row["episode"] = standing.told->episode;
    row["doubt"] = name_of(standing.told->doubt);
  }
  return row;
}

json described(const std::vector<FenceStanding>& standings, const Snapshot& state) {
  json rows = json::array();
  for (const FenceStanding& standing : standings) rows.push_back(described(standing, state));
  return rows;
}

json described_last(const RecentEvent& recent, bool is_of_nearest) {
  const bool is_begin = recent.event.kind == EventKind::began;
  return {{"sequence", recent.event.sequence},
          {"what", is_of_nearest ? (is_begin ? "nearest" : "no longer nearest") : (is_begin ? "enter" : "exit")},
          {"object", recent.a},
          {"why", name_of(recent.event.reason)},
          {"doubt", name_of(recent.event.of.doubt)},
          {"low_ns", recent.low_ns()},
          {"high_ns", recent.high_ns()}};
}

/// The rule of a question for the nearest.
json described_nearest(const FenceLook& look) {
  json told{{"nearest", look.name},
            {"to", look.rule.carrier},
            {"only", look.rule.only},
            {"skip", look.rule.skip},
            {"mask", look.rule.mask},
            {"within", look.rule.nearest->within_m},
            {"hysteresis", look.rule.nearest->hysteresis_m},
            {"keep", look.rule.owner == 0},
            {"cut_short", look.cut_short}};
  if (look.rule.carrier.empty()) told["point"] = numbers(std::get<Sphere>(look.body.primitives.front()).center);
  return told;
}

/// The rule of a fence, and where it stands.
json described(const FenceLook& look) {
  if (look.rule.nearest) return described_nearest(look);
  json told{{"fence", look.name},     {"kind", kind_of(look.body)},  {"to", look.rule.carrier},
            {"only", look.rule.only}, {"skip", look.rule.skip},      {"mask", look.rule.mask},
            {"tells", json::array()}, {"keep", look.rule.owner == 0}};
  for (const auto& [word, bit] : {std::pair("enter", kEnter), std::pair("exit", kExit), std::pair("cross", kCross)}) {
    if ((look.rule.tells & bit) != 0) told["tells"].push_back(word);
  }
  return told;
}

}  // namespace

/// The world's thread says who is in the fence; how far in is worked out on the thread for costly pairs.
void Commands::explain_fence_later(CommandAsk ask, const Arguments& arguments) {
  try {
    arguments.allow_only({arguments.has("fence") ? "fence" : "nearest", "why_not", "most", "deadline_ns"});
  } catch (const BadCommand& bad) { return send(ask, ReplyStatus::refused, refusal_text(bad.what(), bad.hint)); }
  const auto shared = std::make_shared<CommandAsk>(std::move(ask));
  if (!with_.inbox.push_job([this, shared] { explain_fence_of(*shared); }))
    send(*shared, ReplyStatus::refused, refusal_text("too many commands wait already", "ask again"));
}

void Commands::explain_fence_of(const CommandAsk& ask) {
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
    push_fairly("explain", costly_jobs_, {.client = ask.client, .cost = kFenceCost}, [this, job, look] {
      if (!is_wanted(*job)) return;
      answer(job->ask, [&] { return finished(*job, [&] { return explained_fence(**look, *job); }); });
    });
  } catch (const BadCommand& bad) { send(ask, ReplyStatus::refused, refusal_text(bad.what(), bad.hint)); }
}

json Commands::explained_fence(const FenceLook& look, const AwaitedJob& job) const {
  constexpr std::uint64_t kMostOutside = 1'000;
  if (stopping_.load()) throw BadCommand("the server is stopping");
  const Arguments arguments(job.ask.text);
  const SnapshotRing::Lease state = with_.loop.world().newest();
  FenceExplanationAsk ask{.most_outside = arguments.whole("most", 3, kMostOutside)};
  if (const std::string name = arguments.text("why_not"); !name.empty()) ask.why_not = find_shown(*state, name);
  Deadline deadline(job.deadline_ns, &job.called_off);
  const FenceExplanation told = explain_fence(*state, look, ask, with_.part_meshes, deadline);
  json answer = described(look);
  answer["placed"] = told.is_carrier_there;
  answer["looked_at"] = told.looked_at;
  const bool is_of_nearest = look.rule.nearest.has_value();
  answer[is_of_nearest ? "is" : "inside"] = described(told.inside, *state);
  answer[is_of_nearest ? "others" : "outside"] = described(told.outside, *state);
  answer["left_out"] = described(told.left_out, *state);
  if (told.asked_for) answer["asked_for"] = described(*told.asked_for, *state);
  answer["events"] = json::array();
  for (const RecentEvent& event : with_.loop.recent_events(BroadcastOf::fences).last_of(look.id, kLastEvents))
    answer["events"].push_back(described_last(event, is_of_nearest));
  if (told.is_late) answer["late"] = true;
  answer["version"] = state->version;
  answer["time_ns"] = state->world_time_ns;
  return answer;
}

}  // namespace collided::engine::service
