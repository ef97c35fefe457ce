#include "tests/model/plain_world.hpp"

#include <algorithm>
#include <array>

namespace collided::model {
using namespace engine;

void PlainWorld::add_scene(const Scene& scene) {
  for (const SceneObject& object : scene.objects) {
    define({.name = object.name,
            .scene = scene.name,
            .shape = object.shape,
            .pose = object.pose,
            .filter = object.filter,
            .moving = false});
  }
  scenes_.push_back(scene);
  scenes_.back().objects.clear();
}

void PlainWorld::remove_scene(const std::string& name) {
  std::erase_if(objects_, [&](const auto& object) { return object.second.definition.scene == name; });
  std::erase_if(scenes_, [&](const Scene& scene) { return scene.name == name; });
  if (covers_.erase(name) > 0) was_covered_ = true;
}

void PlainWorld::define(const ObjectDefinition& definition) {
  objects_.emplace(definition.name, Object{.definition = definition, .before = definition.pose});
}

void PlainWorld::move(const std::string& name, const Pose& pose, std::int64_t time_ns, bool teleport) {
  Object& object = objects_.at(name);
  object.before = object.definition.pose;
  object.before_ns = object.posed_ns;
  object.definition.pose = pose;
  object.posed_ns = std::max(object.posed_ns, time_ns);
  object.has_motion = !teleport;
  object.moved_while_stale = object.is_stale;
}

void PlainWorld::set_stale(const std::string& name, bool is_stale) {
  Object& object = objects_.at(name);
  if (object.is_stale == is_stale) return;
  object.is_stale = is_stale;
  object.moved_while_stale = false;
}

void PlainWorld::stepped(std::int64_t now_ns) {
  now_ns_ = now_ns;
  for (auto& [name, object] : objects_) {
    if (!object.is_shown && object.definition.moving) object.posed_ns = object.before_ns = now_ns;
    object.is_shown = true;
  }
}

bool PlainWorld::has_scene(std::string_view name) const {
  return std::any_of(scenes_.begin(), scenes_.end(), [&](const Scene& scene) { return scene.name == name; });
}

bool PlainWorld::has_name(const std::string& name) const {
  const auto has_part = [&](const Scene& scene) {
    return std::any_of(scene.parts.begin(), scene.parts.end(), [&](const Part& part) { return part.name == name; });
  };
  return objects_.contains(name) || std::any_of(scenes_.begin(), scenes_.end(), has_part);
}

bool PlainWorld::has_stale() const {
  return std::any_of(objects_.begin(), objects_.end(), [](const auto& object) { return object.second.is_stale; });
}

Scene PlainWorld::allowed_parts(const Scene& scene, const Allows& allows) {
  if (!allows) return scene;
  Scene some{.name = scene.name};
  some.mesh.vertices = scene.mesh.vertices;
  for (Part part : scene.parts) {
    if (!allows(part.name, part.filter.layers)) continue;
    const auto first = scene.mesh.triangles.begin() + part.first_triangle;
    part.first_triangle = static_cast<std::uint32_t>(some.mesh.triangles.size());
    some.mesh.triangles.insert(some.mesh.triangles.end(), first, first + part.triangle_count);
    some.parts.push_back(part);
  }
  return some;
}

std::unique_ptr<World> PlainWorld::make(std::span<const std::string> order, const Allows& allows) const {
  auto world = std::make_unique<World>(WorldOptions{});
  for (const Scene& scene : scenes_) {
    Scene copy = allowed_parts(scene, allows);
    if (copy.parts.empty()) continue;
    const auto indexed = World::index_scene(copy, {.threads = 1, .progress = {}, .cancelled = {}});
    world->add_scene(indexed);
  }
  if (was_covered_) world->state_covers("gone", {});
  for (const auto& [scene, boxes] : covers_) world->state_covers(scene, boxes);
  place_objects(*world, order, allows);
  return world;
}

/// Each object goes the last of its ways: to where that began, from there to where it is.
void PlainWorld::place_objects(World& world, std::span<const std::string> order, const Allows& allows) const {
  std::vector<std::pair<ObjectId, const Object*>> placed;
  for (const std::string& name : order) {
    const auto found = objects_.find(name);
    if (found == objects_.end() || (allows && !allows(name, found->second.definition.filter.layers))) continue;
    ObjectDefinition definition = found->second.definition;
    if (definition.moving) definition.pose = found->second.before;
    placed.emplace_back(std::get<ObjectId>(world.define(definition)), &found->second);
  }
  world.step(0, 1, {});
  for (const auto& [id, object] : placed) {
    if (object->is_stale && object->moved_while_stale) world.set_stale(id, true);
    if (object->definition.moving) world.move(id, object->before, object->before_ns, true);
  }
  world.step(0, 1, {});
  for (const auto& [id, object] : placed) {
    if (object->definition.moving) world.move(id, object->definition.pose, object->posed_ns, !object->has_motion);
    if (object->is_stale && !object->moved_while_stale) world.set_stale(id, true);
  }
  world.step(now_ns_, 1, {});
}

}  // namespace collided::model
