#include <optional>
#include <string>
#include <vector>

#include "client/library/explaining/explain_reading.hpp"
#include "client/library/explaining/explanations.hpp"

namespace collided::client {
namespace {

Pose read_pose(const nlohmann::json& n) {
  return {.position = vector_of(n), .rotation = Quat(n.at(3), n.at(4), n.at(5), n.at(6))};
}

ExplainedBody read_body(const nlohmann::json& row) {
  ExplainedBody body;
  body.object = row.at("object");
  body.remembered = row.at("remembered");
  if (!body.remembered) return body;
  body.moving = row.at("moving");
  body.publisher = row.at("publisher");
  body.pose = read_pose(row.at("pose"));
  body.motion_from = time_if(row, "motion_from_ns");
  body.motion_to = time_if(row, "motion_to_ns");
  return body;
}

std::optional<ExplainedGap> read_gap(const nlohmann::json& answer, const char* key) {
  if (!answer.contains(key)) return std::nullopt;
  const nlohmann::json& row = answer.at(key);
  return ExplainedGap{.time = time_in(row, "time_ns"),
                      .verdict = verdict_word(row, "touching"),
                      .clearance_m = row.at("clearance"),
                      .error_m = number_or_inf(row.at("error"))};
}

ExplainedEvent read_event(const nlohmann::json& answer) {
  ExplainedEvent told;
  told.sequence = answer.at("sequence");
  told.of = answer.at("of") == "fences" ? EventsOf::fences : EventsOf::contacts;
  told.what = answer.at("what");
  told.why = answer.at("why");
  told.doubt = answer.at("doubt");
  told.a = answer.at("a");
  told.b = answer.at("b");
  told.margin = answer.value("margin", "");
  told.within = answer.value("within", "");
  told.low = time_in(answer, "low_ns");
  told.high = time_in(answer, "high_ns");
  told.why_wide = answer.at("why_wide").get<std::vector<std::string>>();
  for (const nlohmann::json& row : answer.at("bodies")) told.bodies.push_back(read_body(row));
  told.before = read_gap(answer, "before");
  told.after = read_gap(answer, "after");
  told.world_time = time_in(answer, "world_time_ns");
  told.version = answer.at("version");
  return told;
}

}  // namespace

Result<ExplainedEvent> explain_event(Connection& connection, std::uint64_t sequence, EventsOf of,
                                     const ExplainOptions& options) {
  if (auto error = time_fault("explain", {}, options.deadline)) return *error;
  return explain(connection, {{"event", sequence}, {"of", of == EventsOf::fences ? "fences" : "contacts"}}, options,
                 read_event);
}

}  // namespace collided::client
