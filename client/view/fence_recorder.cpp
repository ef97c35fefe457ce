#include "client/view/fence_recorder.hpp"

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
constexpr std::chrono::seconds kFencePatience{1};

constexpr const char* kListSchema = R"({"title":"collided.Fences","type":"object","properties":{
"fences":{"type":"array","items":{"type":"object","properties":{
 "name":{"type":"string"},"to":{"type":"string"},"within":{"type":"number"},"nearest_to":{"type":"string"},"distance":{"type":"number"},
 "inside":{"type":"array","items":{"type":"string"}},"in_doubt":{"type":"array","items":{"type":"string"}},
 "lines":{"type":"array","items":{"type":"array","items":{"type":"number"}}},"definition":{"type":"object"}}}}}})";

/// Where an object is; nothing where it is not there.
std::optional<Pose> pose_of(Client& client, const std::string& name) {
  const nlohmann::json arguments{{"name", name}};
  const Result<std::string> text = client.command(wire_contract::command::kGet, arguments.dump(), {}, kFencePatience);
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

FenceRecorder::FenceRecorder(Recording& recording, const std::string& name_space)
    : recording_(recording),
      client_(recording.client()),
      follower_(client_),
      listed_{name_space + "/fences", "json", "collided.Fences", "jsonschema", kListSchema},
      scene_{"/fences", "json", kSceneUpdateSchema.name, "jsonschema", kSceneUpdateSchema.json_schema},
      next_(Clock::now()) {}

void FenceRecorder::look() {
  if (Clock::now() < next_) return;
  const std::uint64_t changes = recording_.counts().fence_changes;
  if (!follower_.has_any() && changes == changes_) return;
  next_ = Clock::now() + kPeriod;
  changes_ = changes;
  auto others = follower_.look();
  const bool are_others = others.has_value();
  if (are_others) fences_ = std::move(*others);
  const std::map<std::string, Pose> before = std::exchange(carriers_, {});
  look_at_carriers();
  if (are_others) static_cast<void>(recording_.write(listed_, fences_text(fences_)));
  if (are_others || !are_same(before, carriers_)) write();
}

void FenceRecorder::look_at_carriers() {
  constexpr std::size_t kMostCarriers = 50;
  for (const draw::FenceOutline& fence : fences_) {
    if (fence.to.empty() || carriers_.contains(fence.to) || carriers_.size() == kMostCarriers) continue;
    if (const std::optional<Pose> pose = pose_of(client_, fence.to)) carriers_.emplace(fence.to, *pose);
  }
}

/// A file has no frames for its scenes: what is carried is put where its carrier is, and without one has no place.
void FenceRecorder::write() {
  std::vector<draw::FenceOutline> placed;
  std::ranges::copy_if(fences_, std::back_inserter(placed), [&](const draw::FenceOutline& fence) {
    return fence.to.empty() || carriers_.contains(fence.to);
  });
  const std::chrono::nanoseconds now = std::chrono::system_clock::now().time_since_epoch();
  static_cast<void>(recording_.write(scene_, fence_update(placed, carriers_, now)));
}

}  // namespace collided::view
