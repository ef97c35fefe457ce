#include <fmt/format.h>

#include "idl/answers/pair.hpp"
#include "idl/described_json.hpp"
#include "server/geometry/mesh.hpp"
#include "server/service/commands/certificate_encoding.hpp"
#include "server/service/commands/measuring_commands.hpp"
#include "server/service/questions/group_names.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {

using nlohmann::json;
using wire_contract::ReplyStatus;

namespace {

ClearancePair answer_of(const MemberPair& pair, const Snapshot& state, bool with_certificate) {
  const auto info_of = [&](ObjectId id) -> const ObjectInfo& { return *state.objects[slot_of(id)]; };
  const ObjectClearance& found = pair.clearance;
  ClearancePair row{.a = info_of(pair.a).name,
                    .b = info_of(pair.b).name,
                    .a_id = pair.a,
                    .b_id = pair.b,
                    .verdict = verdict_of(found.touches),
                    .stale = pair.is_stale,
                    .clearance_m = found.clearance_m,
                    .error_m = found.error_m,
                    .contained = static_cast<Containment>(found.contained),
                    .on_a = found.on_a,
                    .on_b = found.on_b,
                    .point_error_m = found.point_error_m,
                    .normal = found.normal,
                    .a_triangle = info_of(pair.a).reported_triangle(found.a_triangle),
                    .b_triangle = info_of(pair.b).reported_triangle(found.b_triangle)};
  if (pair.proof) row.certificate = certificate_of(*pair.proof);
  else if (with_certificate) row.no_certificate = pair.no_proof;
  return row;
}

UndecidedReason reason_of(const GroupClearance& found) {
  if (found.touches != Decision::undecided) return UndecidedReason::none;
  if (found.is_late) return UndecidedReason::deadline;
  if (found.uncovered) return UndecidedReason::not_covered;
  return found.is_stale ? UndecidedReason::stale_object : UndecidedReason::numeric;
}

/// A certificate has up to a few thousand numbers.
constexpr std::uint64_t kMostCertificates = 1'000;

std::uint64_t parts_of(const Snapshot& state, const std::vector<ObjectId>& ids) {
  std::uint64_t count = 0;
  for (const ObjectId id : ids) {
    const ObjectInfo& info = *state.objects[slot_of(id)];
    count += info.primitives.size() + (info.mesh ? info.mesh->mesh->triangles.size() : info.part_triangles);
  }
  return count;
}

/// The search is best first, so that it mostly examines about one part in eight.
constexpr double kPartsPerCost = 8;

ClearanceAsk clearance_options_of(const Arguments& arguments) {
  ClearanceAsk options;
  options.certificates = arguments.truth("certificate");
  options.with_filtered = arguments.truth("with_filtered");
  options.most = options.certificates ? arguments.whole("most", kMostCertificates) : arguments.whole("most");
  if (options.most == 0) throw BadCommand("clearance: 'most' is 0; allowed 1 and more");
  options.within_m = arguments.number("nearer_m");
  if (options.within_m < 0)
    throw BadCommand(fmt::format("clearance: 'nearer_m' is {}; allowed 0 and more", options.within_m));
  return options;
}

std::vector<ObjectId> group_of(const Snapshot& state, const std::string& text, const std::string& skip) {
  auto meant = objects_meant(state, "clearance", text, skip);
  if (const auto* refusal = std::get_if<Refusal>(&meant)) throw BadCommand(refusal->reason);
  auto group = std::get<std::vector<ObjectId>>(std::move(meant));
  for (const ObjectId id : group) require_whole(state, id, "clearance");
  return group;
}

}  // namespace

/// Finds what the command names; throws BadCommand.
MeasuringCommands::AskedGroups MeasuringCommands::asked_groups(const AwaitedJob& job) const {
  if (threads_.are_stopping()) throw BadCommand("clearance: the server is stopping");
  const Arguments arguments(job.ask.text);
  AskedGroups asked{{.newest = with_.loop.world().newest()}, clearance_options_of(arguments)};
  asked.past = past_state(arguments, *asked.newest);
  asked.options.deadline_ns = job.deadline_ns;
  asked.options.called_off = &job.called_off;
  if (arguments.truth("progress")) {
    asked.options.progress = [this, whose = CommandAsk{job.ask.client, job.ask.request, {}, {}}](double fraction) {
      answers_.answering().send_text(whose.client, whose.request, ReplyStatus::progress,
                                     fmt::format("{{\"fraction\": {:.4f}}}", fraction));
    };
  }
  const std::string from = arguments.text("from");
  const std::string to = arguments.text("to");
  const std::string skip = arguments.text("skip");
  const Snapshot& state = asked.state();
  asked.options.from = group_of(state, from, skip);
  asked.options.is_all_else = to.empty();
  asked.options.to = to.empty() ? all_others(state, asked.options.from, skip) : group_of(state, to, skip);
  if (asked.options.to.empty())
    throw BadCommand(fmt::format("clearance: beside {} nothing is in the world", printable(from)),
                     "--to names the other group; a group may be measured against itself");
  if (asked.options.to.size() == 1 && asked.options.from == asked.options.to)
    throw BadCommand(fmt::format("clearance: both groups are {} alone", printable(from)), "two objects are needed");
  const std::uint64_t parts = parts_of(state, asked.options.from) + parts_of(state, asked.options.to);
  asked.cost = static_cast<double>(parts) / kPartsPerCost * (asked.options.certificates ? kDetailCost : 1);
  return asked;
}

json MeasuringCommands::measured(const AskedGroups& asked) const {
  const Snapshot& state = asked.state();
  const GroupClearance found = clearance_of(state, asked.options, with_.part_meshes);
  ClearanceAnswer answer{.verdict = verdict_of(found.touches),
                         .reason = reason_of(found),
                         .cut = found.is_cut,
                         .late = found.is_late,
                         .stale = found.is_stale,
                         .uncovered = found.uncovered,
                         .from_count = asked.options.from.size(),
                         .to_count = asked.options.to.size(),
                         .filtered = found.filtered,
                         .tested = found.tested,
                         .version = state.version};
  for (const MemberPair& pair : found.pairs) answer.pairs.push_back(answer_of(pair, state, asked.options.certificates));
  return json_of(answer);
}

void MeasuringCommands::clearance_later(CommandAsk ask, const Arguments& arguments) {
  static_cast<void>(clearance_options_of(arguments));  // refuses wrong options at once
  in_turn(std::move(ask), arguments, "clearance", &MeasuringCommands::asked_groups, &MeasuringCommands::measured);
}

}  // namespace collided::engine::service
