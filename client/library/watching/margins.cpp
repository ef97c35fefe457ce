#include "client/library/watching/margins.hpp"

#include <algorithm>
#include <cmath>

#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/commands.hpp"

namespace collided {
namespace client {
namespace {

constexpr std::chrono::seconds kMarginTimeout{10};

nlohmann::json margin_arguments(const Margin& margin) {
  nlohmann::json arguments{
      {"name", margin.name},     {"around", margin.around},           {"only", margin.only},
      {"bands", margin.bands_m}, {"hysteresis", margin.hysteresis_m}, {"dwell_ns", margin.dwell.count()},
      {"keep", margin.keep}};
  if (!margin.skip.empty()) arguments["skip"] = margin.skip;
  if (margin.mask != 0xffffffff) arguments["mask"] = margin.mask;
  return arguments;
}

/// What JSON cannot carry, or the server would read as something else.
std::string refusal_of_margin(const Margin& margin) {
  if (!std::all_of(margin.bands_m.begin(), margin.bands_m.end(), [](double m) { return std::isfinite(m); }))
    return "a band is not finite";
  if (!std::isfinite(margin.hysteresis_m)) return "its hysteresis is not finite";
  if (margin.dwell.count() < 0) return "its dwell is negative";
  return {};
}

ListedMargin listed_margin(const nlohmann::json& row) {
  ListedMargin listed{.margin = {.name = row.at("margin"),
                                 .around = row.at("around"),
                                 .only = row.at("only"),
                                 .skip = row.at("skip"),
                                 .mask = row.at("mask"),
                                 .bands_m = row.at("bands"),
                                 .hysteresis_m = row.at("hysteresis"),
                                 .dwell = std::chrono::nanoseconds(row.at("dwell_ns").get<std::int64_t>()),
                                 .keep = row.at("keep")},
                      .pairs = {}};
  for (const nlohmann::json& pair : row.at("pairs")) {
    listed.pairs.push_back({.object = pair.at("object"),
                            .around = pair.at("around"),
                            .within_m = pair.at("within"),
                            .is_in_doubt = pair.at("in_doubt")});
  }
  return listed;
}

}  // namespace

Result<AddedMargin> add_margin(Connection& connection, const Margin& margin) {
  if (const std::string reason = refusal_of_margin(margin); !reason.empty())
    return bad_input("margin '" + margin.name + "': " + reason);
  nlohmann::json arguments = margin_arguments(margin);
  try {
    static_cast<void>(arguments.dump());
  } catch (const nlohmann::json::exception&) { return bad_input("margin: a name or glob is not UTF-8 text"); }
  return read_answer(
      command(connection, wire_contract::command::kFence, arguments, kMarginTimeout), "fence",
      [](const nlohmann::json& answer) { return AddedMargin{.parts = answer.value("parts", std::uint64_t{0})}; });
}

Result<std::size_t> remove_margins(Connection& connection, const std::string& name) {
  const nlohmann::json arguments{{"name", name}, {"remove", true}, {"margins", true}};
  return read_answer(command(connection, wire_contract::command::kFence, arguments, kMarginTimeout), "fence",
                     [](const nlohmann::json& answer) { return answer.at("fences").size(); });
}

Result<std::vector<ListedMargin>> list_margins(Connection& connection, const std::string& name_glob) {
  const nlohmann::json arguments{{"name", name_glob}, {"margins", true}};
  return read_answer(command(connection, wire_contract::command::kFences, arguments, kMarginTimeout), "fences",
                     [](const nlohmann::json& answer) {
                       std::vector<ListedMargin> margins;
                       for (const nlohmann::json& row : answer.at("margins")) margins.push_back(listed_margin(row));
                       return margins;
                     });
}

}  // namespace client

}  // namespace collided
