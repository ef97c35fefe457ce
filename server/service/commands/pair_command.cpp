#include <fmt/format.h>

#include <cmath>

#include "server/geometry/mesh.hpp"
#include "server/service/commands/commands.hpp"
#include "server/service/commands/nearest_word.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/audit/fcl_opinion.hpp"
#include "server/world/query/pair_report.hpp"

namespace collided::engine::service {

using nlohmann::json;
using wire_contract::ReplyStatus;

namespace {

json numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// JSON has no infinity; it is written as the text "inf".
json number(double value) { return std::isfinite(value) ? json(value) : json("inf"); }

json described(const ProofPart& proof_part) {
  static constexpr const char* kBeside[] = {"nothing", "ball", "box", "ellipsoid", "disc", "half_space"};
  using Summand = PartNumbers::Summand;
  const PartNumbers set = numbers_of(proof_part.part);
  json part{{"beside", kBeside[static_cast<std::size_t>(set.summand)]}, {"points", json::array()}};
  if (proof_part.triangle != kNoTriangle) part["triangle"] = proof_part.triangle;
  for (const Vec3& point : set.points) part["points"].push_back(numbers(point));
  if (set.summand == Summand::box || set.summand == Summand::ellipsoid || set.summand == Summand::half_space) {
    part["axes"] = {numbers(set.axes.col(0)), numbers(set.axes.col(1)), numbers(set.axes.col(2))};
    part["half_m"] = numbers(set.half_m);
  }
  if (set.summand == Summand::ball || set.summand == Summand::disc) part["radius_m"] = set.radius_m;
  if (set.summand == Summand::disc) part["tapers"] = set.tapers;
  return part;
}

json described(const ProofStep& step) {
  switch (step.kind) {
    case ProofStep::Kind::plane: return {{"normal", numbers(step.normal)}, {"point", numbers(step.point)}};
    case ProofStep::Kind::split_a: return {{"split_a", step.at}};
    case ProofStep::Kind::split_b: break;
  }
  return {{"split_b", step.at}};
}

json described(const Proof& proof) {
  json certificate{{"touches", proof.touches}, {"a", json::array()}, {"b", json::array()}};
  for (const ProofPart& part : proof.a) certificate["a"].push_back(described(part));
  for (const ProofPart& part : proof.b) certificate["b"].push_back(described(part));
  if (proof.touches) {
    certificate["point"] = {proof.point[0], proof.point[1], proof.point[2]};
    certificate["divisor"] = proof.divisor;
    certificate["mix_a"] = proof.mix_a;
    certificate["mix_b"] = proof.mix_b;
    return certificate;
  }
  certificate["steps"] = json::array();
  for (const ProofStep& step : proof.steps) certificate["steps"].push_back(described(step));
  return certificate;
}

void describe_touching(const PairReport& report, json& answer) {
  const Contact& contact = report.contact;
  answer["depth"] = contact.depth_m + 0.0;
  answer["error"] = number(contact.depth_error_m);
  answer["normal"] = numbers(contact.normal);
  answer["point"] = numbers(contact.point);
  answer["a_triangle"] = report.a_triangle;
  answer["b_triangle"] = report.b_triangle;
  answer["manifold"] = json::array();
  for (const ManifoldPoint& p : report.manifold) {
    answer["manifold"].push_back(
        {p.point.x(), p.point.y(), p.point.z(), p.depth_m, number(p.depth_error_m), p.a_triangle, p.b_triangle});
  }
}

void describe_apart(const PairReport& report, json& answer) {
  static constexpr const char* kContained[] = {"", "a", "b"};
  answer["distance"] = report.separation.distance_m;
  answer["error"] = number(report.separation.error_m);
  answer["normal"] = numbers(report.separation.normal);
  answer["on_a"] = numbers(report.separation.on_a);
  answer["on_b"] = numbers(report.separation.on_b);
  answer["point_error"] = number(report.separation.point_error_m);
  answer["contained"] = kContained[static_cast<std::size_t>(report.contained)];
}

/// The answer to `pair` as idl/commands.hpp lists it.
json described(const PairReport& report, const PairAsk& ask) {
  static constexpr const char* kAnswers[] = {"miss", "hit", "undecided"};
  json answer{{"answer", kAnswers[static_cast<std::size_t>(report.touches)]}};
  if (report.touches == Decision::yes) describe_touching(report, answer);
  if (report.touches == Decision::no) describe_apart(report, answer);
  if (report.is_stale) answer["stale"] = true;
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
  if (report.proof) answer["certificate"] = described(*report.proof);
  else if (ask.certificate) answer["no_certificate"] = report.no_proof;
  return answer;
}

/// The object of that name in this state; throws BadCommand with the nearest names.
ObjectId find_shown(const Snapshot& state, const std::string& name) {
  std::vector<std::string_view> others;
  for (const auto& info : *state.objects) {
    if (!info) continue;
    if (info->name == name) return info->id;
    others.push_back(info->name);
  }
  throw BadCommand(unknown_object(name, others));
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

bool has_parts(const ObjectInfo& info) {
  return !info.primitives.empty() || (info.mesh && !info.mesh->mesh->triangles.empty()) || info.part_triangles > 0;
}

}  // namespace

/// The state at the named instant; null for the latest. Throws BadCommand.
std::shared_ptr<const Snapshot> Commands::past_state(const std::string& text, const Snapshot& newest) const {
  const std::optional<wire_contract::AskedInstant> instant = wire_contract::asked_instant(text);
  if (!instant) throw BadCommand(fmt::format("pair: as_of {} is no instant", printable(text)));
  if (instant->kind == wire_contract::AskedInstant::Kind::latest) return nullptr;
  auto past = answering_->past_states().at(*instant, newest);
  if (const auto* why_not = std::get_if<std::string>(&past)) throw BadCommand("pair: " + *why_not);
  return std::get<std::shared_ptr<const Snapshot>>(std::move(past));
}

/// Checks the arguments at once and examines the pair on the thread for pairs.
void Commands::pair_later(CommandAsk ask, const Arguments& arguments) {
  const auto work = [this](const Arguments& asked) -> json {
    if (stopping_.load()) throw BadCommand("pair: the server is stopping");
    const SnapshotRing::Lease newest = with_.loop.world().newest();
    const std::shared_ptr<const Snapshot> past = past_state(asked.text("as_of"), *newest);
    const Snapshot* const state = past ? past.get() : &*newest;
    const ObjectId a = find_shown(*state, asked.text("a"));
    const ObjectId b = find_shown(*state, asked.text("b"));
    if (a == b)
      throw BadCommand(fmt::format("pair: both are {}", printable(asked.text("a"))), "two objects are needed");
    for (const ObjectId id : {a, b}) {
      const ObjectInfo& info = *(*state->objects)[slot_of(id)];
      if (!has_parts(info)) throw BadCommand(fmt::format("pair: object {} has no part", printable(info.name)));
    }
    const PairAsk options{
        .certificate = asked.truth("certificate", false),
        .triangles = asked.truth("triangles", false),
        .most_crossings = static_cast<std::uint32_t>(asked.whole("most", 10'000, wire_contract::kMaxTrianglePairs))};
    const bool is_fcl_asked = wants_opinion(asked);
    const PairReport report = report_pair(*state, a, b, options);
    json answer = described(report, options);
    if (is_fcl_asked)
      answer["opinion"] = described(fcl_opinion(*state, a, b, report, [this] { return stopping_.load(); }));
    answer["version"] = state->version;
    return answer;
  };
  try {
    arguments.allow_only({"a", "b", "certificate", "triangles", "most", "as_of", "opinion"});
    make_room("pair", pair_jobs_);
  } catch (const BadCommand& bad) {
    answering_->send_text(ask.client, ask.request, ReplyStatus::refused, refusal_text(bad.what(), bad.hint));
    return;
  }
  const auto shared = std::make_shared<CommandAsk>(std::move(ask));
  pair_jobs_.push([this, shared, work] { answer(*shared, [&] { return work(Arguments(shared->text)); }); });
}

}  // namespace collided::engine::service
