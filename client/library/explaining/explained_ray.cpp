#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "client/library/connection/errors.hpp"
#include "client/library/explaining/explain_reading.hpp"
#include "client/library/explaining/explanations.hpp"

namespace collided::client {
namespace {

Rung rung_in(const nlohmann::json& row) {
  const std::string word = row.at("level");
  return word == "double" ? Rung::filter : word == "expansion" ? Rung::expansion : Rung::rational;
}

UndecidedReason reason_in(const nlohmann::json& row) {
  static constexpr const char* kWords[] = {"",          "numeric",  "stale_object", "recovering",
                                           "truncated", "deadline", "not_covered"};
  const auto* const found = std::find(std::begin(kWords), std::end(kWords), row.at("reason").get<std::string>());
  // A word of a later server.
  if (found == std::end(kWords)) return UndecidedReason::numeric;
  return static_cast<UndecidedReason>(found - std::begin(kWords));
}

ExplainedMeeting read_meeting(const nlohmann::json& row) {
  ExplainedMeeting met;
  met.object = row.at("object");
  met.kind = row.at("kind");
  met.distance_m = row.at("distance");
  met.error_m = number_or_inf(row.at("error"));
  met.point = vector_of(row.at("point"));
  met.normal = vector_of(row.at("normal"));
  met.triangle = row.at("triangle");
  if (row.contains("part")) met.part = row.at("part").get<std::uint32_t>();
  met.rung = rung_in(row);
  met.inside = row.at("inside");
  met.stale = row.value("stale", false);
  met.age = time_if(row, "age_ns");
  met.why_left_out = row.value("why", "");
  return met;
}

ExplainedMiss read_miss(const nlohmann::json& row) {
  ExplainedMiss miss;
  miss.object = row.at("object");
  miss.verdict = verdict_word(row, "hit");
  miss.distance_m = number_or_inf(row.at("distance"));
  miss.error_m = number_or_inf(row.at("error"));
  miss.along_m = row.at("along");
  miss.on_ray = vector_of(row.at("on_ray"));
  miss.on_object = vector_of(row.at("on_object"));
  miss.point_error_m = number_or_inf(row.at("point_error"));
  miss.triangle = row.at("triangle");
  const std::string where = row.at("where");
  miss.where = where == "start" ? WhereMissed::start : where == "end" ? WhereMissed::end : WhereMissed::beside;
  miss.box_met = row.at("box_met");
  miss.why_left_out = row.value("why", "");
  return miss;
}

ExplainedRay read_ray(const nlohmann::json& answer) {
  ExplainedRay told;
  told.verdict = verdict_word(answer, "hit");
  told.reason = reason_in(answer);
  told.rung = rung_in(answer);
  told.nodes = answer.at("nodes");
  told.exact_tests = answer.at("exact_tests");
  told.objects = answer.at("objects");
  told.boxes_met = answer.at("boxes_met");
  told.left_out_count = answer.at("left_out_count");
  for (const nlohmann::json& row : answer.at("met")) told.met.push_back(read_meeting(row));
  for (const nlohmann::json& row : answer.at("left_out")) told.left_out.push_back(read_meeting(row));
  for (const nlohmann::json& row : answer.at("misses")) told.misses.push_back(read_miss(row));
  for (const nlohmann::json& row : answer.at("stale"))
    told.stale.push_back({.object = row.at("object"), .age = time_in(row, "age_ns"), .from_m = row.at("from")});
  told.unknown = answer.at("unknown").get<std::vector<std::string>>();
  if (answer.contains("not_covered")) {
    const nlohmann::json& leaving = answer.at("not_covered");
    told.uncovered =
        Uncovered{.point = vector_of(leaving.at("point")), .covered_m = number_or_inf(leaving.at("covered"))};
  }
  told.cut = answer.value("cut", false);
  told.late = answer.value("late", false);
  told.world_time = time_in(answer, "time_ns");
  told.version = answer.at("version");
  return told;
}

}  // namespace

Result<ExplainedRay> explain_ray(Connection& connection, const RayQuestion& ray, const ExplainOptions& options) {
  if (auto error = time_fault("explain", options.as_of, options.deadline)) return *error;
  const Vec3& o = ray.origin;
  const Vec3& d = ray.direction;
  if (!o.allFinite() || !d.allFinite()) return bad_input("explain: the ray has a number that is not finite");
  if (!(ray.length_m >= 0)) return bad_input("explain: length_m is " + words(ray.length_m) + "; allowed 0 or more");
  nlohmann::json arguments{{"ray", {o.x(), o.y(), o.z(), d.x(), d.y(), d.z()}},
                           {"only", options.only},
                           {"skip", options.skip},
                           {"mask", options.mask},
                           {"most", options.most},
                           {"why_not", options.why_not},
                           {"as_of", wire_contract::text_of(instant_of(options.as_of))}};
  if (std::isfinite(ray.length_m)) arguments["length"] = ray.length_m;
  return explain(connection, std::move(arguments), options, read_ray);
}

}  // namespace collided::client
