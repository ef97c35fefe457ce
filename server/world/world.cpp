#include "server/world/world.hpp"

#include <cassert>
#include <cmath>

#include "server/geometry/float_environment.hpp"
#include "server/world/sweep.hpp"
#include "server/world/world_state.hpp"

namespace collided {
namespace {

double radius_of(const TriangleMesh& mesh) {
  double radius_m = 0;
  for (const Vec3& vertex : mesh.vertices) radius_m = std::max(radius_m, vertex.stableNorm());
  return radius_m * (1 + 0x1p-48);  // outward over the roundings of the norm
}

Refusal name_taken(const std::string& name, const ObjectInfo* holder) {
  const std::string of = holder != nullptr && !holder->scene.empty() ? " (of scene '" + holder->scene + "')" : "";
  return {"the name '" + name + "' is taken" + of + "; names are unique in a world. Nothing was added"};
}

}  // namespace

ObjectTable& World::State::table() {
  ++table_version;
  if (objects_shared) {
    objects = std::make_shared<ObjectTable>(*objects);
    objects_shared = false;
  }
  return *objects;
}

const ObjectInfo* World::State::info(ObjectId id) const {
  const std::uint32_t slot = slot_of(id);
  const ObjectInfo* found = slot < objects->size() ? (*objects)[slot].get() : nullptr;
  return found != nullptr && found->id == id ? found : nullptr;
}

void World::State::mark(std::uint32_t slot, Motion how) {
  if (motion[slot] == Motion::none) moved_slots.push_back(slot);
  motion[slot] = std::max(motion[slot], how);
}

ObjectId World::State::take_slot() {
  std::uint32_t slot = static_cast<std::uint32_t>(generations.size());
  if (!free_slots.empty()) {
    slot = free_slots.back();
    free_slots.pop_back();
    ++generations[slot];
  } else {
    generations.push_back(1);
    table().emplace_back();
    poses.emplace_back();
    frames.emplace_back();
    bounds.emplace_back();
    posed_ns.push_back(0);
    stale.push_back(0);
    changed.push_back(0);
    lone_spheres.emplace_back();
    motion.push_back(Motion::none);
    frames_before.emplace_back();
    posed_before_ns.push_back(0);
  }
  return (static_cast<ObjectId>(generations[slot]) << 32) | slot;
}

World::World(const WorldOptions& options) : state_(std::make_unique<State>()) {
  state_->options = options;
  state_->objects = std::make_shared<ObjectTable>();
  // Readers may come before the first step: the first state is an empty world.
  step(0, 0, {});
}

World::~World() = default;

std::shared_ptr<StaticScene> World::index_scene(Scene& scene, const BspOptions& options) {
  const OwnFloatEnvironment own_floats;
  auto indexed = std::make_shared<StaticScene>();
  indexed->name = scene.name;
  indexed->mesh = std::move(scene.mesh);
  indexed->parts = scene.parts;
  indexed->tree = BspTree::build(indexed->mesh, options);
  return indexed;
}

std::variant<std::uint32_t, Refusal> World::add_scene(const Scene& scene, std::shared_ptr<StaticScene> indexed) {
  State& s = *state_;
  const std::size_t added = scene.parts.size() + scene.objects.size();
  if (s.names.size() + added > s.options.max_objects) {
    return Refusal{"scene '" + scene.name + "' has " + std::to_string(added) + " objects; with the " +
                   std::to_string(s.names.size()) + " loaded that is over the limit of " +
                   std::to_string(s.options.max_objects) + " (max_objects). Nothing was added"};
  }
  for (const Part& part : scene.parts) {
    if (const auto taken = s.names.find(part.name); taken != s.names.end()) {
      return name_taken(part.name, s.info(taken->second));
    }
  }
  for (const SceneObject& object : scene.objects) {
    if (const auto taken = s.names.find(object.name); taken != s.names.end()) {
      return name_taken(object.name, s.info(taken->second));
    }
  }
  for (std::uint32_t part = 0; part < scene.parts.size(); ++part) {
    const ObjectId id = s.take_slot();
    auto info = std::make_shared<ObjectInfo>();
    info->id = id;
    info->name = scene.parts[part].name;
    info->scene = scene.name;
    info->filter = scene.parts[part].filter;
    info->scene_part = part;
    info->part_triangles = scene.parts[part].triangle_count;
    s.table()[slot_of(id)] = info;
    s.names.emplace(info->name, id);
    s.mark(slot_of(id), Motion::placed);
    indexed->part_objects.push_back(id);
  }
  s.scenes.push_back(std::move(indexed));
  for (const SceneObject& object : scene.objects) {
    [[maybe_unused]] const auto defined = define({.name = object.name,
                                                  .scene = scene.name,
                                                  .shape = object.shape,
                                                  .pose = object.pose,
                                                  .filter = object.filter,
                                                  .moving = false});
    assert(std::holds_alternative<ObjectId>(defined) && "names and limits were checked above");
  }
  // What was there before may touch what came: every mover is looked at again.
  for (std::uint32_t slot = 0; slot < s.objects->size(); ++slot) {
    if ((*s.objects)[slot] && (*s.objects)[slot]->moving) s.mark(slot, Motion::placed);
  }
  return static_cast<std::uint32_t>(added);
}

std::uint32_t World::remove_scene(std::string_view name) {
  State& s = *state_;
  std::uint32_t removed_count = 0;
  for (std::uint32_t slot = 0; slot < s.objects->size(); ++slot) {
    const ObjectInfo* info = (*s.objects)[slot].get();
    if (info == nullptr || info->scene != name) continue;
    remove(info->id, wire_contract::EndReason::geometry_changed);
    ++removed_count;
  }
  std::erase_if(s.scenes, [&](const auto& scene) { return scene->name == name; });
  return removed_count;
}

std::variant<ObjectId, Refusal> World::define(const ObjectDefinition& definition) {
  const OwnFloatEnvironment own_floats;
  State& s = *state_;
  if (const auto taken = s.names.find(definition.name); taken != s.names.end()) {
    return name_taken(definition.name, s.info(taken->second));
  }
  if (s.names.size() >= s.options.max_objects) {
    return Refusal{"object '" + definition.name + "' is one more than the limit of " +
                   std::to_string(s.options.max_objects) + " objects (max_objects). Nothing was added"};
  }
  auto info = std::make_shared<ObjectInfo>();
  if (definition.shape.mesh) {
    std::weak_ptr<const IndexedMesh>& shared = s.meshes[definition.shape.mesh.get()];
    info->mesh = shared.lock();
    if (!info->mesh) {
      auto indexed = std::make_shared<IndexedMesh>();
      indexed->mesh = definition.shape.mesh;
      indexed->tree = BspTree::build(*definition.shape.mesh, {.threads = 1, .progress = {}, .cancelled = {}});
      indexed->radius_m = radius_of(*definition.shape.mesh);
      shared = indexed;
      info->mesh = indexed;
    }
  }
  const ObjectId id = s.take_slot();
  const std::uint32_t slot = slot_of(id);
  info->id = id;
  info->name = definition.name;
  info->scene = definition.scene;
  info->filter = definition.filter;
  info->moving = definition.moving;
  info->lost_policy = definition.lost_policy;
  info->publisher = definition.publisher;
  info->primitives = definition.shape.primitives;
  s.lone_spheres[slot] = lone_sphere(*info);
  s.table()[slot] = info;
  s.names.emplace(info->name, id);
  s.poses[slot] = definition.pose;
  s.frames[slot] = s.frames_before[slot] = frame_of(definition.pose);
  s.bounds[slot] = bounds_of(*info, s.frames[slot]);
  // A mover is where it is from the next step's world time on.
  s.posed_ns[slot] = s.posed_before_ns[slot] = definition.moving ? kPosedAtStep : 0;
  s.mark(slot, Motion::placed);
  return id;
}

bool World::remove(ObjectId id, wire_contract::EndReason reason) {
  State& s = *state_;
  const ObjectInfo* info = s.info(id);
  if (info == nullptr) return false;
  const std::uint32_t slot = slot_of(id);
  s.names.erase(info->name);
  if (info->mesh) std::erase_if(s.meshes, [](const auto& entry) { return entry.second.expired(); });
  s.removed.emplace_back(id, reason);
  s.freed_this_step.push_back(slot);
  if (s.stale[slot] != 0) --s.stale_count;
  s.stale[slot] = 0;
  s.bounds[slot] = Aabb{};
  s.lone_spheres[slot].reset();
  s.table()[slot].reset();
  s.mark(slot, Motion::placed);
  return true;
}

bool World::move(ObjectId id, const Pose& pose, std::int64_t time_ns, bool teleport) {
  const OwnFloatEnvironment own_floats;
  State& s = *state_;
  const ObjectInfo* info = s.info(id);
  if (info == nullptr || info->scene_part != 0xffffffff) return false;
  const std::uint32_t slot = slot_of(id);
  if (s.motion[slot] == Motion::none) {
    s.frames_before[slot] = s.frames[slot];
    s.posed_before_ns[slot] = s.posed_ns[slot];
  }
  s.poses[slot] = pose;
  s.frames[slot] = frame_of(pose);
  s.bounds[slot] = bounds_of(*info, s.frames[slot]);
  s.posed_ns[slot] = time_ns;
  s.mark(slot, teleport ? Motion::placed : Motion::moved);
  return true;
}

bool World::has_moved(ObjectId id) const {
  return slot_of(id) < state_->motion.size() && state_->motion[slot_of(id)] != Motion::none;
}

void World::set_stale(ObjectId id, bool is_stale) {
  State& s = *state_;
  if (s.info(id) == nullptr) return;
  const std::uint32_t slot = slot_of(id);
  const std::uint8_t flag = is_stale ? 1 : 0;
  if (s.stale[slot] == flag) return;
  s.stale[slot] = flag;
  s.stale_count += is_stale ? 1 : static_cast<std::uint32_t>(-1);
  s.changed[slot] = s.step_count + 1;
}

const std::vector<Event>& World::events() const { return state_->ledger.events(); }
const StepCost& World::cost() const { return state_->cost; }
const std::vector<OpenContact>& World::contacts() const { return state_->ledger.open(); }
std::uint64_t World::last_event_sequence() const { return state_->ledger.last_sequence(); }

std::optional<ObjectId> World::find(std::string_view name) const {
  const auto found = state_->names.find(std::string(name));
  if (found == state_->names.end()) return std::nullopt;
  return found->second;
}

const ObjectInfo* World::info(ObjectId id) const { return state_->info(id); }
const ObjectTable& World::objects() const { return *state_->objects; }
SnapshotRing::Lease World::newest() const { return state_->ring.newest(); }

}  // namespace collided
