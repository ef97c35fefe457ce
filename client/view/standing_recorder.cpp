#include "client/view/standing_recorder.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/view/foxglove_scene.hpp"
#include "client/view/page_messages.hpp"
#include "idl/commands.hpp"

namespace collided::view {
namespace {

constexpr std::chrono::milliseconds kPeriod{200};
constexpr std::chrono::seconds kCarrierPatience{1};

constexpr const char* kListSchema = R"({"title":"collided.Standing","type":"object","properties":{
"standing":{"type":"array","items":{"type":"object","properties":{
 "name":{"type":"string"},"form":{"type":"string"},"only":{"type":"string"},"skip":{"type":"string"},"mask":{"type":"integer"},
 "keep":{"type":"boolean"},"kind":{"type":"string"},"to":{"type":"string"},"detect":{"type":"array","items":{"type":"string"}},
 "around":{"type":"string"},"bands":{"type":"array","items":{"type":"number"}},"dwell_ns":{"type":"integer"},
 "point":{"type":"array","items":{"type":"number"}},"within":{"type":"number"},"hysteresis":{"type":"number"},
 "id":{"type":"integer"},"about":{"type":"string"},"band":{"type":"number"},"distance":{"type":"number"},
 "holds":{"type":"array","items":{"type":"object","properties":{
  "object":{"type":"string"},"other":{"type":"string"},"band":{"type":"number"},"in_doubt":{"type":"boolean"},"since_ns":{"type":"integer"}}}},
 "lines":{"type":"array","items":{"type":"array","items":{"type":"number"}}}}}}}})";

/// The pose of an object; nothing if it does not exist.
std::optional<Pose> pose_of(Client& client, const std::string& name) {
  const nlohmann::json arguments{{"name", name}};
  const Result<std::string> text = client.command(wire_contract::command::kGet, arguments.dump(), {}, kCarrierPatience);
  if (!text) return std::nullopt;
  const nlohmann::json answer = nlohmann::json::parse(*text, nullptr, false);
  const auto pose = answer.is_object() ? answer.find("pose") : answer.end();
  if (!answer.is_object() || pose == answer.end() || !pose->is_array() || pose->size() != 7) return std::nullopt;
  std::array<double, 7> n{};
  for (std::size_t i = 0; i < n.size(); ++i) {
    if (!(*pose)[i].is_number()) return std::nullopt;
    n[i] = (*pose)[i].get<double>();
  }
  return Pose{{n[0], n[1], n[2]}, Quat(n[3], n[4], n[5], n[6])};
}

bool are_same(const std::map<std::string, Pose>& a, const std::map<std::string, Pose>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& other) {
    return one.first == other.first && one.second.position == other.second.position &&
           one.second.rotation.coeffs() == other.second.rotation.coeffs();
  });
}

}  // namespace

StandingRecorder::StandingRecorder(Recording& recording, const std::string& name_space)
    : recording_(recording),
      client_(recording.client()),
      follower_(client_),
      listed_{name_space + "/standing", "json", kStandingSchemaName, "jsonschema", kListSchema},
      scene_{"/fences", "json", kSceneUpdateSchema.name, "jsonschema", kSceneUpdateSchema.json_schema},
      next_(Clock::now()) {}

void StandingRecorder::look() {
  if (Clock::now() < next_) return;
  const std::uint64_t changes = recording_.counts().standing_changes;
  if (!follower_.has_any() && changes == changes_) return;
  next_ = Clock::now() + kPeriod;
  changes_ = changes;
  auto others = follower_.look();
  const bool are_others = others.has_value();
  if (are_others) outlines_ = std::move(*others);
  const std::map<std::string, Pose> before = std::exchange(carriers_, {});
  look_at_carriers();
  if (are_others) static_cast<void>(recording_.write(listed_, standing_text(outlines_)));
  if (are_others || !are_same(before, carriers_)) write();
}

void StandingRecorder::look_at_carriers() {
  constexpr std::size_t kMostCarriers = 50;
  for (const draw::StandingOutline& outline : outlines_) {
    const std::string& carrier = outline.carrier();
    if (carrier.empty() || carriers_.contains(carrier) || carriers_.size() == kMostCarriers) continue;
    if (const std::optional<Pose> pose = pose_of(client_, carrier)) carriers_.emplace(carrier, *pose);
  }
}

/// A file has no frames for its scenes, so lines are placed by their carrier's pose; without a carrier they are left
/// out.
void StandingRecorder::write() {
  std::vector<draw::StandingOutline> placed;
  std::ranges::copy_if(outlines_, std::back_inserter(placed), [&](const draw::StandingOutline& outline) {
    return outline.carrier().empty() || carriers_.contains(outline.carrier());
  });
  const std::chrono::nanoseconds now = std::chrono::system_clock::now().time_since_epoch();
  static_cast<void>(recording_.write(scene_, standing_update(placed, carriers_, now)));
}

}  // namespace collided::view
