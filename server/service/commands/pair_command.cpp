#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "server/geometry/mesh.hpp"
#include "server/service/commands/certificate_encoding.hpp"
#include "server/service/commands/measuring_commands.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/audit/fcl_opinion.hpp"
#include "server/world/query/pair_report.hpp"

namespace collided::engine::service {

using nlohmann::json;

namespace {

void describe_touching(const PairReport& report, json& answer) {
  const Contact& contact = report.contact;
  answer["depth"] = contact.depth_m + 0.0;
  answer["error"] = number_or_inf(contact.depth_error_m);
  answer["normal"] = numbers(contact.normal);
  answer["point"] = numbers(contact.point);
  answer["a_triangle"] = report.a_triangle;
  answer["b_triangle"] = report.b_triangle;
  answer["manifold"] = json::array();
  for (const ManifoldPoint& p : report.manifold) {
    answer["manifold"].push_back(
        {p.point.x(), p.point.y(), p.point.z(), p.depth_m, number_or_inf(p.depth_error_m), p.a_triangle, p.b_triangle});
  }
}

void describe_apart(const PairReport& report, json& answer) {
  static constexpr const char* kContained[] = {"", "a", "b"};
  answer["distance"] = report.separation.distance_m;
  answer["error"] = number_or_inf(report.separation.error_m);
  answer["normal"] = numbers(report.separation.normal);
  answer["on_a"] = numbers(report.separation.on_a);
  answer["on_b"] = numbers(report.separation.on_b);
  answer["point_error"] = number_or_inf(report.separation.point_error_m);
  answer["contained"] = kContained[static_cast<std::size_t>(report.contained)];
  if (!report.within) return;
  answer["depth"] = report.within->depth_m + 0.0;
  answer["depth_error"] = number_or_inf(report.within->depth_error_m);
}

/// The answer to `pair` as idl/commands.hpp lists it.
json described(const PairReport& report, const PairAsk& ask) {
  static constexpr const char* kAnswers[] = {"miss", "hit", "undecided"};
  json answer{{"answer", kAnswers[static_cast<std::size_t>(report.touches)]}};
  if (report.touches == Decision::yes) describe_touching(report, answer);
  if (report.touches == Decision::no) describe_apart(report, answer);
  if (report.is_stale) answer["stale"] = true;
  if (report.is_late) answer["late"] = true;
  if (ask.triangles) {
    answer["pair_count"] = report.crossing_count;
    answer["cut"] = report.crossing_count > report.crossings.size();
    json& pairs = answer["triangle_pairs"] = json::array();
    for (const TriangleCrossing& c : report.crossings) {
      const Vec3& from = c.crossing.from;
      const Vec3& to = c.crossing.to;
      pairs.push_back({c.a, c.b, from.x(), from.y(), from.z(), to.x(), to.y(), to.z(), c.crossing.error_m});
    }
  }
  if (report.proof) answer["certificate"] = certificate_json(*report.proof);
  else if (ask.certificate) answer["no_certificate"] = report.no_proof;
  return answer;
}

json described(const Opinion& opinion) {
  json said{{"verdict", name_of(opinion.verdict)}};
  if (opinion.touches) said["touches"] = *opinion.touches;
  if (opinion.distance_m) said["distance"] = *opinion.distance_m;
  if (!opinion.why.empty()) said["why"] = opinion.why;
  return said;
}

/// Whether FCL's opinion is wanted; throws BadCommand for any other name.
bool wants_opinion(const Arguments& asked) {
  const std::string whose = asked.text("opinion");
  if (!whose.empty() && whose != "fcl")
    throw BadCommand(fmt::format("pair: 'opinion' is {}; allowed: fcl", printable(whose)));
  return !whose.empty();
}

double part_count(const ObjectInfo& info) {
  const std::size_t own_triangles = info.mesh ? info.mesh->mesh->triangles.size() : 0;
  return static_cast<double>(info.primitives.size() + std::max<std::size_t>(own_triangles, info.part_triangles));
}

bool has_parts(const ObjectInfo& info) { return part_count(info) > 0; }

/// Another library's opinion, in a process of its own, takes as long as about so many triangles.
constexpr double kOpinionCost = 100'000;

}  // namespace

/// Finds what the command names; throws BadCommand.
MeasuringCommands::AskedPair MeasuringCommands::asked_pair(const AwaitedJob& job) const {
  if (threads_.are_stopping()) throw BadCommand("the server is stopping");
  const Arguments arguments(job.ask.text);
  AskedPair asked{{.newest = with_.loop.world().newest()}};
  asked.past = past_state(arguments, *asked.newest);
  asked.a = find_shown(asked.state(), arguments.text("a"));
  asked.b = find_shown(asked.state(), arguments.text("b"));
  if (asked.a == asked.b)
    throw BadCommand(fmt::format("{}: both are {}", arguments.command(), printable(arguments.text("a"))),
                     "two objects are needed");
  asked.options = {.certificate = arguments.truth("certificate"),
                   .triangles = arguments.truth("triangles"),
                   .most_crossings = arguments.whole_32("most"),
                   .deadline_ns = job.deadline_ns,
                   .called_off = &job.called_off};
  asked.is_fcl_asked = wants_opinion(arguments);
  for (const ObjectId id : {asked.a, asked.b}) {
    const ObjectInfo& info = *asked.state().objects[slot_of(id)];
    if (!has_parts(info))
      throw BadCommand(fmt::format("{}: object {} has no part", arguments.command(), printable(info.name)));
    require_whole(asked.state(), id, arguments.command());
    asked.cost += part_count(info);
  }
  if (asked.options.certificate || asked.options.triangles) asked.cost *= kDetailCost;
  if (asked.is_fcl_asked) asked.cost += kOpinionCost;
  return asked;
}

json MeasuringCommands::examined(const AskedPair& asked) const {
  const PairReport report = report_pair(asked.state(), asked.a, asked.b, asked.options);
  json answer = described(report, asked.options);
  if (asked.is_fcl_asked) {
    const auto cancelled = [this] { return threads_.are_stopping(); };
    answer["opinion"] = described(fcl_opinion(asked.state(), asked.a, asked.b, report, cancelled));
  }
  answer["version"] = asked.state().version;
  return answer;
}

void MeasuringCommands::pair_later(CommandAsk ask, const Arguments& arguments) {
  in_turn(std::move(ask), arguments, "pair", &MeasuringCommands::asked_pair, &MeasuringCommands::examined);
}

}  // namespace collided::engine::service
