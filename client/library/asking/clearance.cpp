#include "client/library/asking/clearance.hpp"

#include <cmath>

#include "client/library/asking/answer_times.hpp"
#include "client/library/asking/certificate_decoding.hpp"
#include "client/library/asking/question_encoding.hpp"
#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/commands.hpp"

namespace collided::client {
namespace {

Verdict verdict_in(const nlohmann::json& row) {
  const std::string word = row.at("answer");
  return word == "hit" ? Verdict::hit : word == "miss" ? Verdict::miss : Verdict::undecided;
}

ClearancePair read_clearance_pair(const nlohmann::json& row) {
  ClearancePair pair;
  pair.a = row.at("a");
  pair.b = row.at("b");
  pair.a_id = row.at("a_id");
  pair.b_id = row.at("b_id");
  pair.verdict = verdict_in(row);
  pair.stale = row.value("stale", false);
  pair.clearance_m = row.at("clearance");
  pair.error_m = number_or_inf(row.at("error"));
  const std::string contained = row.at("contained");
  pair.contained = contained == "a" ? Containment::a_in_b : contained == "b" ? Containment::b_in_a : Containment::none;
  pair.on_a = vector_of(row.at("on_a"));
  pair.on_b = vector_of(row.at("on_b"));
  pair.point_error_m = number_or_inf(row.at("point_error"));
  pair.normal = vector_of(row.at("normal"));
  pair.a_triangle = row.at("a_triangle");
  pair.b_triangle = row.at("b_triangle");
  if (row.contains("certificate")) pair.certificate = certificate_of(row.at("certificate"));
  pair.no_certificate = row.value("no_certificate", "");
  return pair;
}

ClearanceAnswer read_clearance(const nlohmann::json& text) {
  ClearanceAnswer answer;
  answer.verdict = verdict_in(text);
  answer.cut = text.value("cut", false);
  answer.late = text.value("late", false);
  answer.stale = text.value("stale", false);
  if (text.contains("uncovered")) answer.uncovered = vector_of(text.at("uncovered"));
  if (answer.verdict == Verdict::undecided)
    answer.reason = answer.late        ? UndecidedReason::deadline
                    : answer.uncovered ? UndecidedReason::not_covered
                    : answer.stale     ? UndecidedReason::stale_object
                                       : UndecidedReason::numeric;
  answer.from_count = text.at("from_count");
  answer.to_count = text.at("to_count");
  answer.filtered = text.at("filtered");
  answer.tested = text.at("tested");
  answer.version = text.at("version");
  for (const nlohmann::json& row : text.at("pairs")) answer.pairs.push_back(read_clearance_pair(row));
  return answer;
}

}  // namespace

Result<ClearanceAnswer> clearance(Connection& connection, const std::string& from, const ClearanceOptions& options) {
  if (auto error = time_fault("clearance", options.as_of, options.deadline)) return *error;
  if (!(options.nearer_m >= 0)) {
    return bad_input("clearance: nearer_m is " + words(options.nearer_m) + "; allowed 0 or more");
  }
  nlohmann::json arguments{
      {"from", from},
      {"to", options.to},
      {"skip", options.skip},
      {"most", options.most},
      {"with_filtered", options.with_filtered},
      {"certificate", options.certificate},
      {"as_of", wire_contract::text_of(instant_of(options.as_of))},
      {"deadline_ns",
       (options.progress ? options.deadline : server_deadline(options.deadline, options.timeout)).count()}};
  if (options.progress) arguments["progress"] = true;
  if (std::isfinite(options.nearer_m)) arguments["nearer_m"] = options.nearer_m;
  return read_answer(
      command(connection, wire_contract::command::kClearance, arguments, options.timeout, options.progress),
      "clearance", read_clearance);
}

}  // namespace collided::client
