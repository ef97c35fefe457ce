#include "client/library/asking/pair.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "client/library/asking/question_encoding.hpp"
#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/commands.hpp"

namespace collided::client {
namespace {

using nlohmann::json;
using Numbers = CertifiedPart::Numbers;

/// A number; "inf" is a text, since JSON has no infinity.
double number_of(const json& value) {
  return value.is_string() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

CertifiedPart part_of(const json& value) {
  static constexpr std::array<const char*, 6> kBeside{"nothing", "ball", "box", "ellipsoid", "disc", "half_space"};
  CertifiedPart part;
  const std::string summand = value.at("beside");
  const auto* const found = std::find(kBeside.begin(), kBeside.end(), summand);
  // An unknown kind must not be taken for a smaller set, which would prove too much.
  if (found == kBeside.end()) { throw json::other_error::create(501, "unknown kind of part: " + summand, &value); }
  part.summand = static_cast<CertifiedPart::Summand>(found - kBeside.begin());
  part.triangle = value.value("triangle", kNoTriangle);
  part.points = value.at("points").get<std::vector<Numbers>>();
  part.radius_m = value.value("radius_m", 0.0);
  part.tapers = value.value("tapers", false);
  if (value.contains("axes")) {
    part.axes = value.at("axes").get<std::array<Numbers, 3>>();
    part.half_m = value.at("half_m").get<Numbers>();
  }
  return part;
}

Certificate::Step step_of(const json& value) {
  using Kind = Certificate::Step::Kind;
  if (value.contains("split_a")) { return {.kind = Kind::split_a, .at = value.at("split_a")}; }
  if (value.contains("split_b")) { return {.kind = Kind::split_b, .at = value.at("split_b")}; }
  return {.kind = Kind::plane, .normal = value.at("normal").get<Numbers>(), .point = value.at("point").get<Numbers>()};
}

Certificate certificate_of(const json& value) {
  Certificate certificate;
  certificate.touches = value.at("touches");
  for (const json& part : value.at("a")) { certificate.a.push_back(part_of(part)); }
  for (const json& part : value.at("b")) { certificate.b.push_back(part_of(part)); }
  if (certificate.touches) {
    certificate.point = value.at("point").get<std::array<Certificate::Sum, 3>>();
    certificate.divisor = value.at("divisor").get<Certificate::Sum>();
    certificate.mix_a = value.at("mix_a").get<Certificate::Mix>();
    certificate.mix_b = value.at("mix_b").get<Certificate::Mix>();
    return certificate;
  }
  for (const json& step : value.at("steps")) { certificate.steps.push_back(step_of(step)); }
  return certificate;
}

void read_touching(const json& answer, PairAnswer& pair) {
  pair.depth_m = answer.at("depth");
  pair.point = vector_of(answer.at("point"));
  pair.a_triangle = answer.at("a_triangle");
  pair.b_triangle = answer.at("b_triangle");
  for (const json& row : answer.at("manifold")) {
    pair.manifold.push_back({vector_of(row), row.at(3), number_of(row.at(4)), row.at(5), row.at(6)});
  }
}

void read_apart(const json& answer, PairAnswer& pair) {
  pair.distance_m = answer.at("distance");
  pair.on_a = vector_of(answer.at("on_a"));
  pair.on_b = vector_of(answer.at("on_b"));
  pair.point_error_m = number_of(answer.at("point_error"));
  const std::string contained = answer.at("contained");
  pair.contained = contained == "a" ? Containment::a_in_b : contained == "b" ? Containment::b_in_a : Containment::none;
  pair.is_in_solid = answer.contains("depth");
  if (!pair.is_in_solid) return;
  pair.depth_m = answer.at("depth");
  pair.depth_error_m = number_of(answer.at("depth_error"));
}

SecondOpinion opinion_of(const json& said) {
  SecondOpinion opinion;
  const std::string verdict = said.at("verdict");
  if (verdict == "agree") opinion.verdict = OpinionVerdict::agree;
  if (verdict == "differ") opinion.verdict = OpinionVerdict::differ;
  if (verdict == "failed") opinion.verdict = OpinionVerdict::failed;
  if (said.contains("touches")) opinion.touches = said.at("touches").get<bool>();
  if (said.contains("distance")) opinion.distance_m = said.at("distance").get<double>();
  opinion.why = said.value("why", "");
  return opinion;
}

PairAnswer read(const json& answer) {
  PairAnswer pair;
  const std::string word = answer.at("answer");
  pair.verdict = word == "hit" ? Verdict::hit : word == "miss" ? Verdict::miss : Verdict::undecided;
  pair.stale = answer.value("stale", false);
  if (pair.verdict == Verdict::undecided)
    pair.reason = answer.value("late", false) ? UndecidedReason::deadline
                  : pair.stale                ? UndecidedReason::stale_object
                                              : UndecidedReason::numeric;
  pair.version = answer.at("version");
  if (pair.verdict != Verdict::undecided) {
    pair.normal = vector_of(answer.at("normal"));
    pair.error_m = number_of(answer.at("error"));
  }
  if (pair.verdict == Verdict::hit) {
    read_touching(answer, pair);
  } else if (pair.verdict == Verdict::miss) {
    read_apart(answer, pair);
  }
  if (answer.contains("triangle_pairs")) {
    pair.triangle_pair_count = answer.at("pair_count");
    pair.cut = answer.at("cut");
    for (const json& row : answer.at("triangle_pairs")) {
      pair.triangle_pairs.push_back({row.at(0), row.at(1), Vec3(row.at(2), row.at(3), row.at(4)),
                                     Vec3(row.at(5), row.at(6), row.at(7)), row.at(8)});
    }
  }
  if (answer.contains("certificate")) { pair.certificate = certificate_of(answer.at("certificate")); }
  pair.no_certificate = answer.value("no_certificate", "");
  if (answer.contains("opinion")) pair.opinion = opinion_of(answer.at("opinion"));
  return pair;
}

/// When nobody waits for the answer any longer, so that the server need not work on it. A little later than the
/// timeout: whoever waits is told of that, not of an undecided answer.
std::chrono::nanoseconds given_up_after(const PairOptions& options) {
  constexpr std::chrono::hours kLongest{24};
  return std::clamp<std::chrono::nanoseconds>(options.timeout, std::chrono::nanoseconds(0), kLongest) +
         std::chrono::milliseconds(100);
}

}  // namespace

Result<PairAnswer> pair(Connection& connection, const std::string& a, const std::string& b,
                        const PairOptions& options) {
  if (options.as_of.time.count() < 0) {
    return bad_input("pair: the instant is " + std::to_string(options.as_of.time.count()) + " ns; allowed 0 or more");
  }
  if (options.deadline.count() < 0) {
    return bad_input("pair: the deadline is " + std::to_string(options.deadline.count()) +
                     " ns; allowed 0 (none) and more");
  }
  json arguments{{"a", a},
                 {"b", b},
                 {"certificate", options.certificate},
                 {"triangles", options.triangles},
                 {"most", options.most_triangle_pairs},
                 {"as_of", wire_contract::text_of(instant_of(options.as_of))},
                 {"deadline_ns", (options.deadline.count() > 0 ? options.deadline : given_up_after(options)).count()}};
  if (!options.opinion.empty())
    arguments["opinion"] = options.opinion;  // a server that is older refuses what it does not know
  return read_answer(command(connection, wire_contract::command::kPair, arguments, options.timeout), "pair", read);
}

}  // namespace collided::client
