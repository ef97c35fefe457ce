#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "idl/answers/pair.hpp"
#include "idl/described_json.hpp"
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

void fill_contact(const PairReport& report, PairAnswer& answer) {
  answer.depth_m = report.contact.depth_m;
  answer.error_m = report.contact.depth_error_m;
  answer.normal = report.contact.normal;
  answer.point = report.contact.point;
  answer.a_triangle = report.a_triangle;
  answer.b_triangle = report.b_triangle;
  for (const ManifoldPoint& p : report.manifold)
    answer.manifold.push_back({.point = p.point,
                               .depth_m = p.depth_m,
                               .error_m = p.depth_error_m,
                               .a_triangle = p.a_triangle,
                               .b_triangle = p.b_triangle});
}

void fill_gap(const PairReport& report, PairAnswer& answer) {
  answer.distance_m = report.separation.distance_m;
  answer.error_m = report.separation.error_m;
  answer.normal = report.separation.normal;
  answer.on_a = report.separation.on_a;
  answer.on_b = report.separation.on_b;
  answer.point_error_m = report.separation.point_error_m;
  answer.contained = static_cast<Containment>(report.contained);
  answer.is_in_solid = report.within.has_value();
  if (!report.within) return;
  answer.depth_m = report.within->depth_m;
  answer.depth_error_m = report.within->depth_error_m;
}

UndecidedReason reason_of(const PairReport& report) {
  if (report.touches != Decision::undecided) return UndecidedReason::none;
  if (report.is_late) return UndecidedReason::deadline;
  return report.is_stale ? UndecidedReason::stale_object : UndecidedReason::numeric;
}

PairAnswer answer_of(const PairReport& report, const PairAsk& ask) {
  PairAnswer answer{.verdict = verdict_of(report.touches), .reason = reason_of(report), .stale = report.is_stale};
  if (report.touches == Decision::yes) fill_contact(report, answer);
  if (report.touches == Decision::no) fill_gap(report, answer);
  answer.triangle_pair_count = report.crossing_count;
  answer.cut = report.crossing_count > report.crossings.size();
  for (const TriangleCrossing& c : report.crossings)
    answer.triangle_pairs.push_back({.a_triangle = c.a,
                                     .b_triangle = c.b,
                                     .from = c.crossing.from,
                                     .to = c.crossing.to,
                                     .error_m = c.crossing.error_m});
  if (report.proof) answer.certificate = certificate_of(*report.proof);
  else if (ask.certificate) answer.no_certificate = report.no_proof;
  return answer;
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

/// Another library's opinion, in a process of its own, takes about as long as this many triangles.
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
  PairAnswer answer = answer_of(report, asked.options);
  if (asked.is_fcl_asked) {
    const auto cancelled = [this] { return threads_.are_stopping(); };
    Opinion said = fcl_opinion(asked.state(), asked.a, asked.b, report, cancelled);
    answer.opinion = {
        .verdict = said.verdict, .touches = said.touches, .distance_m = said.distance_m, .why = std::move(said.why)};
  }
  answer.version = asked.state().version;
  return json_of(answer);
}

void MeasuringCommands::pair_later(CommandAsk ask, const Arguments& arguments) {
  in_turn(std::move(ask), arguments, "pair", &MeasuringCommands::asked_pair, &MeasuringCommands::examined);
}

}  // namespace collided::engine::service
