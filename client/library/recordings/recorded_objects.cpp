#include "client/library/recordings/recorded_objects.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/library/recordings/recorded_shape.hpp"
#include "idl/commands.hpp"
#include "idl/glob.hpp"
#include "idl/unit_quaternion.hpp"

namespace collided::client {
namespace {

using nlohmann::json;
namespace command_names = wire_contract::command;

/// Surfaces of the surroundings have numbers of their server, which counts from 1.
constexpr std::uint64_t kFirstRecordedSurface = std::uint64_t{1} << 62;

/// A pose of seven numbers, w first; nothing if they are not a pose.
std::optional<Pose> sound_pose(std::span<const double> n) {
  const Pose pose{{n[0], n[1], n[2]}, Quat(n[3], n[4], n[5], n[6])};
  if (!pose.position.allFinite() || !wire_contract::is_unit_quaternion(pose.rotation)) return std::nullopt;
  return pose;
}

std::optional<Pose> pose_in(const json& object) {
  if (!object.is_object() || !object.contains("pose")) return std::nullopt;
  const auto numbers = object.at("pose").get<std::array<double, 7>>();
  return sound_pose(numbers);
}

Pose placed_on(const Pose& carrier, const Pose& own) {
  return {carrier.rotation * own.position + carrier.position, carrier.rotation * own.rotation};
}

}  // namespace

RecordedObjects::RecordedObjects(std::shared_ptr<const ShownObjects> surroundings)
    : surroundings_(std::move(surroundings)), next_surface_(kFirstRecordedSurface) {
  if (!surroundings_) return;
  for (const ShownObject& object : surroundings_->objects) {
    if (!object.moving) still_.emplace(object.name, &object);
  }
}

void RecordedObjects::define(const wire::Definition& definition) {
  const DefinedBy by{definition.publisher, definition.object_number};
  const std::string name = definition.name;
  const auto lost_policy = static_cast<std::uint8_t>(
      definition.lost_policy & static_cast<std::uint8_t>(~wire_contract::kPolicyEntersWithInstant));
  if (definition.removed) {
    if (defined(by) != nullptr) erase(names_.at(by));
    names_.erase(by);
    return;
  }
  const auto shape = dds::view(definition.shape);
  if (shape.empty()) {
    // It claims an existing object.
    const auto claimed = objects_.find(name);
    if (claimed == objects_.end()) return;
    claimed->second.by = by;
    claimed->second.lost_policy = lost_policy;
  } else {
    std::array<double, 7> numbers{};
    std::copy_n(definition.position, 3, numbers.begin());
    std::copy_n(definition.orientation, 4, numbers.begin() + 3);
    const std::optional<Pose> pose = sound_pose(numbers);
    if (!pose) throw std::runtime_error("a pose does not hold");
    ShownObject object;
    object.name = name;
    object.moving = definition.moving;
    object.layers = definition.layers;
    object.mask = definition.mask;
    object.group = definition.group;
    object.pose = *pose;
    add(std::move(object), by, shape, Vec3::Ones(), lost_policy);
  }
  if (const auto before = names_.find(by); before != names_.end() && before->second != name) {
    if (defined(by) != nullptr) erase(before->second);
  }
  names_[by] = name;
}

void RecordedObjects::place(const wire::PoseBatch& batch) {
  const auto numbers = dds::view(batch.object_numbers);
  const auto positions = dds::view(batch.positions);
  const auto orientations = dds::view(batch.orientations);
  if (positions.size() != 3 * numbers.size() || orientations.size() != 4 * numbers.size())
    throw std::runtime_error("columns of different lengths");
  if (batch.source_time_ns > 0) world_time_ = std::chrono::nanoseconds(batch.source_time_ns);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::array<double, 7> pose{};
    std::ranges::copy(positions.subspan(3 * i, 3), pose.begin());
    std::ranges::copy(orientations.subspan(4 * i, 4), pose.begin() + 3);
    const std::optional<Pose> placed = sound_pose(pose);
    Object* const object = defined({batch.publisher, numbers[i]});
    if (object == nullptr || !placed) continue;
    object->shown.pose = *placed;
    object->shown.stale = false;
    has_new_poses_ = true;
  }
}

void RecordedObjects::lose_lost(const wire::Status& status) {
  const auto publishers = dds::view(status.publishers);
  const auto states = dds::view(status.publisher_states);
  for (std::size_t i = 0; i < std::min(publishers.size(), states.size()); ++i) {
    const bool is_lost = states[i] == static_cast<std::uint8_t>(wire_contract::PublisherState::lost);
    if (!is_lost) lost_.erase(publishers[i]);
    if (!is_lost || !lost_.insert(publishers[i]).second) continue;
    std::vector<std::string> leaving;
    for (auto& [name, object] : objects_) {
      if (object.by.first != publishers[i]) continue;
      if (object.lost_policy == static_cast<std::uint8_t>(wire_contract::LostPolicy::remove)) leaving.push_back(name);
      object.shown.stale = object.lost_policy == static_cast<std::uint8_t>(wire_contract::LostPolicy::freeze);
      has_new_table_ = has_new_poses_ = true;
    }
    for (const std::string& name : leaving) erase(name);
  }
}

void RecordedObjects::carry_out(const json& command, std::span<const std::uint8_t> shape, const json& answer) {
  const auto text = [](const json& from, const char* key) { return from.is_object() ? from.value(key, "") : ""; };
  const std::string what = text(command, "command");
  const std::string name = text(command, "name");
  if (what == command_names::kAdd) {
    add_by_command(command, shape);
  } else if (what == command_names::kMove) {
    if (const std::optional<Pose> pose = pose_in(command)) move(name, *pose);
  } else if (what == command_names::kRemove) {
    const bool is_listed = answer.is_object() && answer.contains("removed");
    remove(is_listed ? answer.at("removed").get<std::vector<std::string>>() : named(name));
  } else if (what == command_names::kClear) {
    clear(text(command, "scene"), command.value("moving", false));
  } else if (what == command_names::kLoad) {
    bring_back(text(answer, "scene"));
  } else if (what == command_names::kAttach) {
    std::optional<Pose> pose = pose_in(answer);
    if (!pose) pose = pose_in(command);
    if (pose) attached_[text(command, "child")] = {text(command, "parent"), *pose};
    has_new_poses_ = true;
  } else if (what == command_names::kDetach) {
    detach(text(command, "child"));
  }
}

void RecordedObjects::add_by_command(const json& command, std::span<const std::uint8_t> shape) {
  const std::optional<Pose> pose = pose_in(command);
  ShownObject object;
  object.name = command.value("name", "");
  object.moving = command.value("moving", true);
  object.layers = command.value("layers", std::uint32_t{1});
  object.mask = command.value("mask", ~std::uint32_t{0});
  object.group = command.value("group", std::uint32_t{0});
  object.pose = pose.value_or(Pose{});
  const auto scale = command.value("scale", std::array<double, 3>{1, 1, 1});
  add(std::move(object), {}, shape, {scale[0], scale[1], scale[2]}, 0);
}

void RecordedObjects::add(ShownObject object, const DefinedBy& by, std::span<const std::uint8_t> shape,
                          const Vec3& scale, std::uint8_t lost_policy) {
  DrawnShape drawn = drawn_shape(shape, scale, next_surface_);
  if (drawn.parts.size() > kMostParts - part_count_) throw std::runtime_error("the objects have too many parts");
  erase(object.name);
  next_surface_ += drawn.runs.size();
  part_count_ += drawn.parts.size();
  object.id = id_of(object.name);
  object.parts = std::move(drawn.parts);
  object.runs = std::move(drawn.runs);
  still_.erase(object.name);
  const std::string name = object.name;
  objects_[name] = {std::move(object), by, lost_policy};
  has_new_table_ = true;
}

void RecordedObjects::erase(const std::string& name) {
  has_new_table_ = has_new_poses_ = true;
  still_.erase(name);
  const auto found = objects_.find(name);
  if (found == objects_.end()) return;
  part_count_ -= found->second.shown.parts.size();
  objects_.erase(found);
}

void RecordedObjects::move(const std::string& name, const Pose& pose) {
  attached_.erase(name);
  const auto found = objects_.find(name);
  if (found == objects_.end()) return;
  found->second.shown.pose = pose;
  // A static object has its pose only in the table.
  has_new_table_ = has_new_table_ || !found->second.shown.moving;
  has_new_poses_ = true;
}

void RecordedObjects::remove(const std::vector<std::string>& names) {
  const std::set<std::string> removed(names.begin(), names.end());
  std::vector<std::string> parted;
  for (const auto& [child, attachment] : attached_) {
    if (removed.contains(child) || removed.contains(attachment.parent)) parted.push_back(child);
  }
  for (const std::string& child : parted) detach(child);
  for (const std::string& name : removed) erase(name);
}

/// Removes a scene, or all objects without a living publisher.
void RecordedObjects::clear(const std::string& scene, bool is_moving_only) {
  std::vector<std::string> leaving;
  for (const ShownObject* object : all()) {
    const auto own = objects_.find(object->name);
    const bool is_published =
        own != objects_.end() && own->second.by.first != 0 && !lost_.contains(own->second.by.first);
    const bool is_of_scene = scene.empty() ? !is_moving_only : object->scene == scene;
    const bool is_other = (scene.empty() || is_moving_only) && (object->moving || !is_moving_only) && !is_published;
    if (object->scene.empty() ? is_other : is_of_scene) leaving.push_back(object->name);
  }
  remove(leaving);
}

/// Shows a scene of the surroundings that was loaded again.
void RecordedObjects::bring_back(const std::string& scene) {
  if (!surroundings_) return;
  for (const ShownObject& object : surroundings_->objects) {
    if (!object.moving && object.scene == scene && !objects_.contains(object.name))
      still_.emplace(object.name, &object);
  }
  has_new_table_ = true;
}

void RecordedObjects::detach(const std::string& child) {
  const auto found = objects_.find(child);
  if (found != objects_.end()) found->second.shown.pose = pose_of(found->second.shown);
  attached_.erase(child);
  has_new_table_ = has_new_poses_ = true;
}

RecordedObjects::Object* RecordedObjects::defined(const DefinedBy& by) {
  const auto name = names_.find(by);
  const auto found = name == names_.end() ? objects_.end() : objects_.find(name->second);
  return found != objects_.end() && found->second.by == by ? &found->second : nullptr;
}

const ShownObject* RecordedObjects::find(const std::string& name) const {
  if (const auto found = objects_.find(name); found != objects_.end()) return &found->second.shown;
  const auto found = still_.find(name);
  return found == still_.end() ? nullptr : found->second;
}

std::vector<const ShownObject*> RecordedObjects::all() const {
  std::vector<const ShownObject*> found;
  for (const auto& [name, object] : still_) found.push_back(object);
  for (const auto& [name, object] : objects_) found.push_back(&object.shown);
  return found;
}

/// The names affected by a removal: that of an object, or those that match.
std::vector<std::string> RecordedObjects::named(const std::string& glob) const {
  if (find(glob) != nullptr) return {glob};
  std::vector<std::string> names;
  for (const ShownObject* object : all()) {
    if (wire_contract::glob_matches(glob, object->name)) names.push_back(object->name);
  }
  return names;
}

/// The pose of an object; an attached object moves along with its parent.
Pose RecordedObjects::pose_of(const ShownObject& object, int depth) const {
  constexpr int kDeepest = 16;
  const auto attached = attached_.find(object.name);
  if (attached == attached_.end() || depth == kDeepest) return object.pose;
  const ShownObject* const parent = find(attached->second.parent);
  return parent == nullptr ? object.pose : placed_on(pose_of(*parent, depth + 1), attached->second.pose);
}

std::uint64_t RecordedObjects::id_of(const std::string& name) {
  return ids_.try_emplace(name, ids_.size() + 1).first->second;
}

std::shared_ptr<const ShownObjects> RecordedObjects::table() {
  auto table = std::make_shared<ShownObjects>();
  table->version = ++version_;
  table->table_version = ++table_version_;
  table->world_time = world_time_;
  for (const ShownObject* object : all()) {
    ShownObject& shown = table->objects.emplace_back(*object);
    shown.id = id_of(shown.name);
    shown.pose = pose_of(*object);
  }
  has_new_table_ = false;
  has_new_poses_ = true;
  return table;
}

Poses RecordedObjects::poses() {
  Poses poses;
  poses.version = ++version_;
  poses.table_version = table_version_;
  poses.world_time = world_time_;
  for (const auto& [name, object] : objects_) {
    if (!object.shown.moving) continue;
    poses.ids.push_back(object.shown.id);
    poses.poses.push_back(pose_of(object.shown));
    poses.stale.push_back(object.shown.stale ? 1 : 0);
  }
  has_new_poses_ = false;
  return poses;
}

}  // namespace collided::client
