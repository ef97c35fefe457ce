#include <string>
#include <utility>
#include <vector>

#include "client/library/asking/pair.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/explaining/explain_reading.hpp"
#include "client/library/explaining/explanations.hpp"

namespace collided::client {
namespace {

ExplainedApproach read_approach(const nlohmann::json& row) {
  const std::string end = row.at("end");
  ExplainedApproach nearest;
  nearest.end = end == "found"       ? ExplainedApproachEnd::found
                : end == "touched"   ? ExplainedApproachEnd::touched
                : end == "undecided" ? ExplainedApproachEnd::undecided
                                     : ExplainedApproachEnd::cut_short;
  nearest.from = time_in(row, "from_ns");
  nearest.to = time_in(row, "to_ns");
  nearest.time = time_in(row, "time_ns");
  nearest.distance_m = number_or_inf(row.at("distance"));
  nearest.error_m = number_or_inf(row.at("error"));
  nearest.at_least_m = number_or_inf(row.at("at_least"));
  nearest.looks = row.at("looks");
  return nearest;
}

ExplainedPair read_explained_pair(const nlohmann::json& answer) {
  ExplainedPair told;
  told.answer = read_pair(answer);
  told.why_not = answer.at("why_not").get<std::vector<std::string>>();
  told.attached = answer.at("attached");
  if (answer.contains("nearest")) told.nearest = read_approach(answer.at("nearest"));
  else told.no_nearest = answer.at("no_nearest");
  return told;
}

}  // namespace

Result<ExplainedPair> explain_pair(Connection& connection, const std::string& a, const std::string& b,
                                   const ExplainOptions& options) {
  if (auto error = time_fault("explain", options.as_of, options.deadline)) return *error;
  if (options.last.count() < 0)
    return bad_input("explain: last is " + words(options.last) + "; allowed 0 (all that is remembered) and more");
  nlohmann::json arguments{{"a", a}, {"b", b}, {"as_of", wire_contract::text_of(instant_of(options.as_of))}};
  if (options.last.count() > 0) arguments["last_ns"] = options.last.count();
  return explain(connection, std::move(arguments), options, read_explained_pair);
}

}  // namespace collided::client
