#include "client/library/watching/nearest.hpp"

#include <algorithm>
#include <cmath>

#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/commands.hpp"

namespace collided {
namespace client {
namespace {

constexpr std::chrono::seconds kNearestTimeout{10};

nlohmann::json nearest_arguments(const NearestQuestion& nearest) {
  nlohmann::json arguments{{"name", nearest.name},
                           {"only", nearest.only},
                           {"within", nearest.within_m},
                           {"hysteresis", nearest.hysteresis_m},
                           {"keep", nearest.keep}};
  if (!nearest.to.empty()) arguments["to"] = nearest.to;
  if (nearest.point) arguments["point"] = {nearest.point->x(), nearest.point->y(), nearest.point->z()};
  if (!nearest.skip.empty()) arguments["skip"] = nearest.skip;
  if (nearest.mask != 0xffffffff) arguments["mask"] = nearest.mask;
  return arguments;
}

ListedNearest listed_nearest(const nlohmann::json& row) {
  ListedNearest listed{.question = {.name = row.at("nearest"),
                                    .only = row.at("only"),
                                    .to = row.at("to"),
                                    .within_m = row.at("within"),
                                    .hysteresis_m = row.at("hysteresis"),
                                    .skip = row.at("skip"),
                                    .mask = row.at("mask"),
                                    .keep = row.at("keep")},
                       .object = row.at("object"),
                       .is_in_doubt = row.at("in_doubt"),
                       .since = {},
                       .cut_short = 0};
  if (row.contains("point")) {
    const auto point = row.at("point").get<std::vector<double>>();
    if (point.size() == 3) listed.question.point = Vec3(point[0], point[1], point[2]);
  }
  listed.cut_short = row.value("cut_short", std::uint64_t{0});
  if (row.contains("since_ns")) listed.since = std::chrono::nanoseconds(row.at("since_ns").get<std::int64_t>());
  return listed;
}

}  // namespace

Result<void> add_nearest(Connection& connection, const NearestQuestion& nearest) {
  // JSON cannot carry these.
  if (!std::isfinite(nearest.within_m) || !std::isfinite(nearest.hysteresis_m))
    return bad_input("nearest '" + nearest.name + "': a distance is not finite");
  if (nearest.point && !nearest.point->allFinite())
    return bad_input("nearest '" + nearest.name + "': the point is not finite");
  return read_answer(command(connection, wire_contract::command::kFence, nearest_arguments(nearest), kNearestTimeout),
                     "fence", [](const nlohmann::json&) {});
}

Result<std::size_t> remove_nearest(Connection& connection, const std::string& name) {
  const nlohmann::json arguments{{"name", name}, {"remove", true}, {"nearest", true}};
  return read_answer(command(connection, wire_contract::command::kFence, arguments, kNearestTimeout), "fence",
                     [](const nlohmann::json& answer) { return answer.at("fences").size(); });
}

Result<std::vector<ListedNearest>> list_nearest(Connection& connection, const std::string& name_glob) {
  const nlohmann::json arguments{{"name", name_glob}, {"nearest", true}, {"limit", 1'000'000}};
  return read_answer(command(connection, wire_contract::command::kFences, arguments, kNearestTimeout), "fences",
                     [](const nlohmann::json& answer) {
                       std::vector<ListedNearest> all;
                       for (const nlohmann::json& row : answer.at("nearest")) all.push_back(listed_nearest(row));
                       return all;
                     });
}

}  // namespace client

}  // namespace collided
