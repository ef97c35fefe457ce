#include "client/draw/drawing/fence_outlines.hpp"

#include <chrono>
#include <nlohmann/json.hpp>

#include "idl/commands.hpp"

namespace collided::draw {
namespace {

std::vector<Vec3> line_of(const nlohmann::json& numbers) {
  std::vector<Vec3> line;
  for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
    line.push_back({numbers[i].get<double>(), numbers[i + 1].get<double>(), numbers[i + 2].get<double>()});
  return line;
}

FenceOutline outline_of(const nlohmann::json& row) {
  FenceOutline outline{.name = row.at("fence").get<std::string>(),
                       .number = row.at("id").get<std::uint64_t>(),
                       .is_plane = row.at("kind").get<std::string>() == "half_space",
                       .to = row.at("to").get<std::string>(),
                       .inside = row.at("inside").get<std::vector<std::string>>(),
                       .in_doubt = row.at("in_doubt").get<std::vector<std::string>>(),
                       .lines = {}};
  if (row.contains("margin")) {
    outline.is_band = true;
    outline.name = row.at("margin").get<std::string>();
    outline.within_m = row.at("within").get<double>();
  }
  for (const char* key : {"kind", "only", "skip", "mask", "tells", "keep", "around", "hysteresis", "dwell_ns"}) {
    const auto value = row.find(key);
    if (value == row.end()) continue;
    outline.definition.emplace(key, value->is_string() ? value->get<std::string>() : value->dump());
  }
  for (const nlohmann::json& line : row.value("lines", nlohmann::json::array())) outline.lines.push_back(line_of(line));
  return outline;
}

}  // namespace

Result<std::vector<FenceOutline>> fence_outlines(Client& client, bool with_lines) {
  const nlohmann::json arguments{{"bands", true}, {"outlines", with_lines}, {"limit", 1'000}};
  const Result<std::string> text =
      client.command(wire_contract::command::kFences, arguments.dump(), {}, std::chrono::seconds(1));
  if (!text) return text.error();
  std::vector<FenceOutline> outlines;
  try {
    const nlohmann::json answer = nlohmann::json::parse(*text);
    for (const nlohmann::json& row : answer.at("fences")) outlines.push_back(outline_of(row));
  } catch (const nlohmann::json::exception& fault) {
    return Error{ErrorCode::refused, std::string("the server's list of fences cannot be read: ") + fault.what(), ""};
  }
  return outlines;
}

std::vector<std::vector<Vec3>> placed_lines(const FenceOutline& outline, const Pose& carrier) {
  std::vector<std::vector<Vec3>> lines = outline.lines;
  for (std::vector<Vec3>& line : lines) {
    for (Vec3& point : line) point = carrier.position + carrier.rotation * point;
  }
  return lines;
}

}  // namespace collided::draw
