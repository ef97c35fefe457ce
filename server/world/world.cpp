#include "server/world/world.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

#include "server/geometry/endless.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/world/indexed_mesh.hpp"
#include "server/world/part_index.hpp"
#include "server/world/scene_levels.hpp"
#include "server/world/sweep.hpp"
#include "server/world/world_state.hpp"

namespace collided {
namespace {

/// The saved index where there is one and it is fit, else one built anew.
BspTree index_of(const TriangleMesh& mesh, const SavedIndex& saved, const std::string& name, const BspOptions& options,
                 std::vector<std::string>& warnings) {
  if (!saved.bytes.empty()) {
    auto loaded = BspTree::load(mesh, saved.bytes, saved.keeper, options.threads);
    if (auto* tree = std::get_if<BspTree>(&loaded)) return std::move(*tree);
    warnings.push_back("the saved index of " + name + " is not used, " + std::get<BspRefusal>(loaded).reason +
                       "; it is built anew");
  }
  return BspTree::build(mesh, options);
}

template <class T>
std::string_view bytes_of(const std::vector<T>& items) {
  return {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T)};
}

/// Bit for bit, so that -0 and 0 are two.
bool are_equal(const TriangleMesh& a, const TriangleMesh& b) {
  return &a == &b || (bytes_of(a.vertices) == bytes_of(b.vertices) && bytes_of(a.triangles) == bytes_of(b.triangles));
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

/// Objects with equal meshes share one with its index, whoever sent them.
std::shared_ptr<const IndexedMesh> World::State::mesh_for(const ObjectDefinition& definition) {
  const std::hash<std::string_view> hash;
  const TriangleMesh& mesh = *definition.shape.mesh;
  const std::size_t key = hash(bytes_of(mesh.vertices)) ^ (31 * hash(bytes_of(mesh.triangles)));
  const auto [first, end] = meshes.equal_range(key);
  for (auto entry = first; entry != end; ++entry) {
    const std::shared_ptr<const IndexedMesh> known = entry->second.lock();
    if (known && are_equal(*known->mesh, mesh)) return known;
  }
  std::shared_ptr<const IndexedMesh> added = definition.indexed;
  if (!added) {
    added = indexed_mesh(definition.shape.mesh,
                         BspTree::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}}));
  }
  std::erase_if(meshes, [](const auto& entry) { return entry.second.expired(); });
  meshes.emplace(key, added);
  return added;
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
    movable.push_back(0);
    lone_spheres.emplace_back();
    has_way.push_back(0);
    sizes.emplace_back();
    fast.push_back(0);
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
  indexed->tree = index_of(indexed->mesh, scene.index, "the scene's mesh", options, indexed->warnings);
  scene.index = {};
  if (!scene.collapses.empty()) {
    indexed->levels = build_levels(indexed->mesh, indexed->tree, indexed->parts, scene.collapses, options.cancelled);
    scene.collapses = {};
  }
  BspOptions quietly = options;
  quietly.progress = {};
  std::unordered_map<const TriangleMesh*, std::shared_ptr<const IndexedMesh>> of_mesh;  // objects that share one share it
  for (SceneObject& object : scene.objects) {
    auto& mesh = indexed->object_meshes.emplace_back();
    if (!object.shape.mesh) continue;
    std::shared_ptr<const IndexedMesh>& known = of_mesh[object.shape.mesh.get()];
    if (known) {
      mesh = known;
      object.index = {};
      continue;
    }
    known = mesh = indexed_mesh(object.shape.mesh, index_of(*object.shape.mesh, object.index, "object " + object.name, quietly,
                                                    indexed->warnings));
    object.index = {};
  }
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
    info->cut = scene.parts[part].cut;
    s.table()[slot_of(id)] = info;
    s.names.emplace(info->name, id);
    s.mark(slot_of(id), Motion::placed);
    indexed->part_objects.push_back(id);
  }
  const std::vector<std::shared_ptr<const IndexedMesh>> meshes = std::move(indexed->object_meshes);
  s.scenes.push_back(std::move(indexed));
  s.apart.clear();
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    [[maybe_unused]] const auto defined = define({.name = object.name,
                                                  .scene = scene.name,
                                                  .shape = object.shape,
                                                  .pose = object.pose,
                                                  .filter = object.filter,
                                                  .moving = false,
                                                  .indexed = i < meshes.size() ? meshes[i] : nullptr,
                                                  .cut = object.cut});
    assert(std::holds_alternative<ObjectId>(defined) && "names and limits were checked above");
  }
  // What was there before may touch what came: every mover is looked at again.
  for (std::uint32_t slot = 0; slot < s.objects->size(); ++slot) {
    if ((*s.objects)[slot] && (*s.objects)[slot]->moving) s.mark(slot, Motion::placed);
  }
  return static_cast<std::uint32_t>(added);
}

void World::State::gather_covers() {
  auto all = std::make_shared<std::vector<Aabb>>();
  for (const auto& [scene, boxes] : covers_of) all->insert(all->end(), boxes.begin(), boxes.end());
  covers = std::move(all);
}

void World::state_covers(std::string_view scene, std::span<const Aabb> boxes) {
  state_->covers_of.insert_or_assign(std::string(scene), std::vector<Aabb>(boxes.begin(), boxes.end()));
  state_->gather_covers();
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
  if (const auto covers = s.covers_of.find(name); covers != s.covers_of.end()) {
    s.covers_of.erase(covers);
    s.gather_covers();
  }
  s.apart.clear();
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
  if (definition.moving && is_endless(definition.shape)) {
    return Refusal{"object '" + definition.name + "' is a half-space that moves: it has no end, so it would be a candidate "
                   "for everything in every step; offered are those that do not move. Nothing was added"};
  }
  auto info = std::make_shared<ObjectInfo>();
  if (definition.shape.mesh) info->mesh = s.mesh_for(definition);
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
  info->parts = index_parts(info->primitives);
  if (definition.cut.piece_of) {
    info->cut = definition.cut;
    info->part_triangles = static_cast<std::uint32_t>(definition.shape.mesh->triangles.size());
  }
  s.movable[slot] = id;
  s.lone_spheres[slot] = lone_sphere(*info);
  s.sizes[slot] = size_of(*info);
  s.has_way[slot] = 0;
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
  s.removed.emplace_back(id, reason);
  s.freed_this_step.push_back(slot);
  s.forget_stale(id);
  s.bounds[slot] = Aabb{};
  s.movable[slot] = 0;
  s.lone_spheres[slot].reset();
  // A part of a scene may have the slot next, and a part has no pose, age or way.
  s.poses[slot] = Pose{};
  s.frames[slot] = s.frames_before[slot] = Frame{};
  s.posed_ns[slot] = s.posed_before_ns[slot] = 0;
  s.has_way[slot] = 0;
  s.table()[slot].reset();
  s.mark(slot, Motion::placed);
  return true;
}

bool World::State::move(ObjectId id, const Pose& pose, std::int64_t time_ns, Motion how) {
  const std::uint32_t slot = slot_of(id);
  if (slot >= movable.size() || movable[slot] != id || id == 0) return false;
  if (motion[slot] == Motion::none) {
    frames_before[slot] = frames[slot];
    posed_before_ns[slot] = posed_ns[slot];
  }
  poses[slot] = pose;
  frames[slot] = frame_of(pose);
  const std::optional<Sphere>& sphere = lone_spheres[slot];
  bounds[slot] = sphere ? collided::bounds(place(frames[slot], *sphere)) : bounds_of(*(*objects)[slot], frames[slot]);
  // An object's time does not go back, whatever its publisher's clock does: brackets are measured in it.
  posed_ns[slot] = std::max(posed_ns[slot], time_ns);
  has_way[slot] = how == Motion::moved ? 1 : 0;
  mark(slot, how);
  return true;
}

/// What move() writes of an object, for writing; a hint, so any slot will do.
void World::State::prefetch(std::uint32_t slot) const {
  if (slot >= movable.size()) return;
  const auto fetch = [](const auto& item) {
    for (std::size_t byte = 0; byte < sizeof item; byte += 64) {
      __builtin_prefetch(reinterpret_cast<const char*>(&item) + byte, 1);
    }
  };
  fetch(frames[slot]);
  fetch(frames_before[slot]);
  fetch(poses[slot]);
  fetch(bounds[slot]);
  fetch(lone_spheres[slot]);
  fetch(movable[slot]);
  fetch(posed_ns[slot]);
  fetch(posed_before_ns[slot]);
}

bool World::move(ObjectId id, const Pose& pose, std::int64_t time_ns, bool teleport) {
  const OwnFloatEnvironment own_floats;
  const bool moved = state_->move(id, pose, time_ns, teleport ? Motion::placed : Motion::moved);
  // Somebody else put it there.
  for (StaleObject& stale : state_->stale_objects) {
    if (stale.id == id) stale.position = pose.position, stale.speed_mps = 0;
  }
  return moved;
}

void World::move(std::span<const ObjectId> ids, std::span<const Pose> poses, std::int64_t time_ns, bool teleport,
                 std::span<bool> moved) {
  constexpr std::size_t kAhead = 8;
  const OwnFloatEnvironment own_floats;
  const Motion how = teleport ? Motion::placed : Motion::moved;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i + kAhead < ids.size()) state_->prefetch(slot_of(ids[i + kAhead]));
    moved[i] = state_->move(ids[i], poses[i], time_ns, how);
  }
}

bool World::has_moved(ObjectId id) const {
  return slot_of(id) < state_->motion.size() && state_->motion[slot_of(id)] != Motion::none;
}

void World::State::forget_stale(ObjectId id) {
  stale[slot_of(id)] = 0;
  std::erase_if(stale_objects, [&](const StaleObject& object) { return object.id == id; });
}

void World::set_stale(ObjectId id, bool is_stale) {
  State& s = *state_;
  if (s.info(id) == nullptr) return;
  const std::uint32_t slot = slot_of(id);
  const std::uint8_t flag = is_stale ? 1 : 0;
  if (s.stale[slot] == flag) return;
  s.changed[slot] = s.step_count + 1;
  if (!is_stale) return s.forget_stale(id);
  s.stale[slot] = flag;
  const double way_s = 1e-9 * static_cast<double>(s.posed_ns[slot] - s.posed_before_ns[slot]);
  const double way_m = (s.frames[slot].position - s.frames_before[slot].position).norm();
  const bool has_speed = s.has_way[slot] != 0 && s.posed_before_ns[slot] != kPosedAtStep && way_s > 0;
  s.stale_objects.push_back({.id = id,
                             .position = s.frames[slot].position,
                             .reach_m = s.sizes[slot].reach_m,
                             .speed_mps = has_speed ? way_m / way_s : 0,
                             .posed_ns = s.posed_ns[slot]});
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
