#include <optional>
#include <string>
#include <vector>

#include "client/library/explaining/explain_reading.hpp"
#include "client/library/explaining/explanations.hpp"

namespace collided::client {
namespace {

ExplainedStanding read_standing(const nlohmann::json& row) {
  ExplainedStanding standing;
  standing.object = row.at("object");
  standing.verdict = verdict_word(row, "inside");
  standing.clearance_m = number_or_inf(row.at("clearance"));
  standing.error_m = number_or_inf(row.at("error"));
  standing.stale = row.value("stale", false);
  standing.told = row.value("told", false);
  standing.since = time_if(row, "since_ns");
  standing.episode = row.value("episode", std::uint64_t{0});
  standing.doubt = row.value("doubt", "");
  standing.why_left_out = row.value("why", "");
  return standing;
}

std::vector<ExplainedStanding> read_standings(const nlohmann::json& rows) {
  std::vector<ExplainedStanding> standings;
  for (const nlohmann::json& row : rows) standings.push_back(read_standing(row));
  return standings;
}

ExplainedNews read_news(const nlohmann::json& row) {
  return {.sequence = row.at("sequence"),
          .what = row.at("what"),
          .object = row.at("object"),
          .why = row.at("why"),
          .doubt = row.at("doubt"),
          .low = time_in(row, "low_ns"),
          .high = time_in(row, "high_ns")};
}

ExplainedFence read_fence(const nlohmann::json& answer) {
  ExplainedFence told;
  told.fence = answer.at("fence");
  told.kind = answer.at("kind");
  told.to = answer.at("to");
  told.only = answer.at("only");
  told.skip = answer.at("skip");
  told.mask = answer.at("mask");
  told.tells = answer.at("tells").get<std::vector<std::string>>();
  told.keep = answer.at("keep");
  told.placed = answer.at("placed");
  told.looked_at = answer.at("looked_at");
  told.inside = read_standings(answer.at("inside"));
  told.outside = read_standings(answer.at("outside"));
  told.left_out = read_standings(answer.at("left_out"));
  if (answer.contains("asked_for")) told.asked_for = read_standing(answer.at("asked_for"));
  for (const nlohmann::json& row : answer.at("events")) told.events.push_back(read_news(row));
  told.late = answer.value("late", false);
  told.world_time = time_in(answer, "time_ns");
  told.version = answer.at("version");
  return told;
}

ExplainedNearest read_nearest(const nlohmann::json& answer) {
  ExplainedNearest told;
  told.nearest = answer.at("nearest");
  told.to = answer.at("to");
  if (answer.contains("point")) told.point = vector_of(answer.at("point"));
  told.only = answer.at("only");
  told.skip = answer.at("skip");
  told.mask = answer.at("mask");
  told.within_m = answer.at("within");
  told.hysteresis_m = answer.at("hysteresis");
  told.keep = answer.at("keep");
  told.placed = answer.at("placed");
  told.looked_at = answer.at("looked_at");
  if (!answer.at("is").empty()) told.is = read_standing(answer.at("is").front());
  told.others = read_standings(answer.at("others"));
  told.left_out = read_standings(answer.at("left_out"));
  if (answer.contains("asked_for")) told.asked_for = read_standing(answer.at("asked_for"));
  for (const nlohmann::json& row : answer.at("events")) told.events.push_back(read_news(row));
  told.cut_short = answer.at("cut_short");
  told.late = answer.value("late", false);
  told.world_time = time_in(answer, "time_ns");
  told.version = answer.at("version");
  return told;
}

}  // namespace

Result<ExplainedNearest> explain_nearest(Connection& connection, const std::string& name,
                                         const ExplainOptions& options) {
  if (auto error = time_fault("explain", {}, options.deadline)) return *error;
  return explain(connection, {{"nearest", name}, {"most", options.most}, {"why_not", options.why_not}}, options,
                 read_nearest);
}

Result<ExplainedFence> explain_fence(Connection& connection, const std::string& name, const ExplainOptions& options) {
  if (auto error = time_fault("explain", {}, options.deadline)) return *error;
  return explain(connection, {{"fence", name}, {"most", options.most}, {"why_not", options.why_not}}, options,
                 read_fence);
}

}  // namespace collided::client
