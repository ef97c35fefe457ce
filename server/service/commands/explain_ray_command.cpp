#include <fmt/format.h>

#include <limits>

#include "server/service/commands/awaited_jobs-inl.hpp"
#include "server/service/commands/certificate_encoding.hpp"
#include "server/service/commands/commands.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {

using nlohmann::json;

namespace {

/// A distance for each of the nearest misses, each about as a pair; most objects are told apart by their boxes.
constexpr double kObjectsPerCost = 100;
constexpr std::uint64_t kMostMisses = 1'000;

/// The ray's seven numbers; throws BadCommand where they are none.
std::array<double, kRayNumbers> ray_numbers(const Arguments& arguments) {
  const std::vector<double> list = arguments.numbers("ray");
  if (list.size() != 6) throw BadCommand(fmt::format("explain: 'ray' has {} numbers; 6 are needed", list.size()));
  std::array<double, kRayNumbers> numbers{};
  std::copy(list.begin(), list.end(), numbers.begin());
  numbers[6] = arguments.number("length", std::numeric_limits<double>::infinity());
  if (!is_question(QuestionKind::ray, numbers.data()))
    throw BadCommand("explain: the ray's direction is 0 0 0 or its length below 0");
  return numbers;
}

const char* word_of(Level level) {
  static constexpr const char* kWords[] = {"double", "expansion", "rational"};
  return kWords[static_cast<std::size_t>(level)];
}

/// What a ray's explanation says in terms of the state's names.
class RayTeller {
 public:
  RayTeller(const Snapshot& state, const RayExplanationAsk& ask) : state_(state), ask_(ask) {}

  json meeting(const RayMeeting& met) const {
    const ObjectInfo& info = info_of(met.hit.object);
    json row{{"object", info.name},
             {"kind", kind_of(info)},
             {"distance", met.hit.distance_m},
             {"error", number_or_inf(met.hit.error_m)},
             {"point", numbers(met.hit.point)},
             {"normal", numbers(met.hit.normal)},
             {"triangle", info.reported_triangle(met.hit.triangle)},
             {"level", word_of(met.level)},
             {"inside", (met.hit.flags & kInside) != 0}};
    if (met.part != RayMeeting::kNoPart) row["part"] = met.part;
    if ((met.hit.flags & kStale) != 0) row["stale"] = true;
    if (state_.posed_ns[slot_of(info.id)] > 0)
      row["age_ns"] = std::max<std::int64_t>(0, state_.world_time_ns - state_.posed_ns[slot_of(info.id)]);
    if (const std::string why = why_left_out(info, ask_); !why.empty()) row["why"] = why;
    return row;
  }
  json miss(const RayMiss& miss) const {
    const ObjectInfo& info = info_of(miss.object);
    json row{{"object", info.name},
             {"answer", miss.meets == Decision::undecided ? "undecided" : "miss"},
             {"distance", miss.distance_m},
             {"error", number_or_inf(miss.error_m)},
             {"along", miss.along_m},
             {"on_ray", numbers(miss.on_ray)},
             {"on_object", numbers(miss.on_object)},
             {"point_error", number_or_inf(miss.point_error_m)},
             {"triangle", info.reported_triangle(miss.triangle)},
             {"box_met", miss.is_box_met},
             {"where", miss.is_at_length  ? "end"
                       : miss.is_at_start ? "start"
                                          : "beside"}};
    if (const std::string why = why_left_out(info, ask_); !why.empty()) row["why"] = why;
    return row;
  }
  json stale(const StaleInTheWay& stale) const {
    return {{"object", info_of(stale.object).name}, {"age_ns", stale.age_ns}, {"from", stale.from_m}};
  }
  json name(ObjectId id) const { return info_of(id).name; }

 private:
  const ObjectInfo& info_of(ObjectId id) const { return *state_.objects[slot_of(id)]; }

  const Snapshot& state_;
  const RayExplanationAsk& ask_;
};

json described(const RayExplanation& told, const Snapshot& state, const RayExplanationAsk& ask) {
  const RayTeller teller(state, ask);
  json answer{{"answer", name_of(told.verdict)},
              {"reason", name_of(told.reason)},
              {"level", word_of(told.level)},
              {"nodes", told.node_count},
              {"exact_tests", told.exact_tests},
              {"objects", told.object_count},
              {"left_out_count", told.left_out_count},
              {"boxes_met", told.boxes_met},
              {"met", json::array()},
              {"left_out", json::array()},
              {"misses", json::array()},
              {"stale", json::array()},
              {"unknown", json::array()},
              {"time_ns", state.world_time_ns},
              {"version", state.version}};
  for (const RayMeeting& met : told.met) answer["met"].push_back(teller.meeting(met));
  for (const RayMeeting& met : told.left_out) answer["left_out"].push_back(teller.meeting(met));
  for (const RayMiss& miss : told.misses) answer["misses"].push_back(teller.miss(miss));
  for (const StaleInTheWay& stale : told.stale) answer["stale"].push_back(teller.stale(stale));
  for (const ObjectId id : told.unknown) answer["unknown"].push_back(teller.name(id));
  if (told.leaves_covered)
    answer["not_covered"] = {{"point", numbers(told.leaves_covered->point)},
                             {"covered", number_or_inf(told.leaves_covered->covered_m)}};
  if (told.is_cut) answer["cut"] = true;
  if (told.is_late) answer["late"] = true;
  return answer;
}

}  // namespace

/// Finds what the command names; throws BadCommand.
Commands::AskedRay Commands::asked_ray(const AwaitedJob& job) const {
  if (stopping_.load()) throw BadCommand("the server is stopping");
  constexpr std::uint64_t kBits = 0xffffffff;
  const Arguments arguments(job.ask.text);
  AskedRay asked{.newest = with_.loop.world().newest(), .past = nullptr};
  asked.past = past_state(arguments, *asked.newest);
  asked.options.numbers = ray_numbers(arguments);
  asked.options.mask = static_cast<std::uint32_t>(arguments.whole("mask", kBits, kBits));
  asked.options.only = arguments.text("only");
  asked.options.skip = arguments.text("skip");
  asked.options.most_misses = arguments.whole("most", 3, kMostMisses);
  if (const std::string name = arguments.text("why_not"); !name.empty())
    asked.options.why_not = find_shown(asked.state(), name);
  asked.deadline_ns = job.deadline_ns;
  asked.called_off = &job.called_off;
  asked.cost = static_cast<double>(asked.state().objects.size()) / kObjectsPerCost;
  for (const auto& scene : asked.state().scenes) asked.cost += static_cast<double>(scene->mesh.triangles.size());
  return asked;
}

json Commands::explained_ray(const AskedRay& asked) const {
  Deadline deadline(asked.deadline_ns, asked.called_off);
  return described(explain_ray(asked.state(), asked.options, with_.part_meshes, deadline), asked.state(),
                   asked.options);
}

}  // namespace collided::engine::service
