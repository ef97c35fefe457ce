#include "client/library/asking/pair.hpp"

#include <algorithm>

#include "client/library/asking/answer_times.hpp"
#include "client/library/asking/certificate_decoding.hpp"
#include "client/library/asking/question_encoding.hpp"
#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/commands.hpp"

namespace collided::client {
namespace {

using nlohmann::json;

void read_touching(const json& answer, PairAnswer& pair) {
  pair.depth_m = answer.at("depth");
  pair.point = vector_of(answer.at("point"));
  pair.a_triangle = answer.at("a_triangle");
  pair.b_triangle = answer.at("b_triangle");
  for (const json& row : answer.at("manifold")) {
    pair.manifold.push_back({vector_of(row), row.at(3), number_or_inf(row.at(4)), row.at(5), row.at(6)});
  }
}

void read_apart(const json& answer, PairAnswer& pair) {
  pair.distance_m = answer.at("distance");
  pair.on_a = vector_of(answer.at("on_a"));
  pair.on_b = vector_of(answer.at("on_b"));
  pair.point_error_m = number_or_inf(answer.at("point_error"));
  const std::string contained = answer.at("contained");
  pair.contained = contained == "a" ? Containment::a_in_b : contained == "b" ? Containment::b_in_a : Containment::none;
  pair.is_in_solid = answer.contains("depth");
  if (!pair.is_in_solid) return;
  pair.depth_m = answer.at("depth");
  pair.depth_error_m = number_or_inf(answer.at("depth_error"));
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

}  // namespace

PairAnswer read_pair(const json& answer) {
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
    pair.error_m = number_or_inf(answer.at("error"));
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

Result<PairAnswer> pair(Connection& connection, const std::string& a, const std::string& b,
                        const PairOptions& options) {
  if (auto error = time_fault("pair", options.as_of, options.deadline)) return *error;
  json arguments{{"a", a},
                 {"b", b},
                 {"certificate", options.certificate},
                 {"triangles", options.triangles},
                 {"most", options.most_triangle_pairs},
                 {"as_of", wire_contract::text_of(instant_of(options.as_of))},
                 {"deadline_ns", server_deadline(options.deadline, options.timeout).count()}};
  if (!options.opinion.empty())
    arguments["opinion"] = options.opinion;  // a server that is older refuses what it does not know
  return read_answer(command(connection, wire_contract::command::kPair, arguments, options.timeout), "pair", read_pair);
}

}  // namespace collided::client
