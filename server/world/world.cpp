#include "server/world/world.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

#include "idl/clocks.hpp"
#include "server/geometry/endless.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/objects/part_index.hpp"
#include "server/world/objects/scene_levels.hpp"
#include "server/world/objects/sweep.hpp"
#include "server/world/world_state.hpp"

namespace collided::engine {
namespace {

/// Returns the saved index if it is valid, else builds one.
Bvh index_of(const TriangleMesh& mesh, const SavedIndex& saved, const std::string& name, const BvhOptions& options,
             std::vector<std::string>& warnings) {
  if (!saved.bytes.empty()) {
    auto loaded = Bvh::load(mesh, saved.bytes, saved.keeper, options.threads);
    if (auto* tree = std::get_if<Bvh>(&loaded)) return std::move(*tree);
    warnings.push_back("the saved index of " + name + " is not used, " + std::get<BvhRefusal>(loaded).reason +
                       "; it is built anew");
  }
  return Bvh::build(mesh, options);
}

template <class T>
std::string_view bytes_of(const std::vector<T>& items) {
  return {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T)};
}

/// Compares bit for bit: -0 and 0 differ.
bool are_equal(const TriangleMesh& a, const TriangleMesh& b) {
  return &a == &b || (bytes_of(a.vertices) == bytes_of(b.vertices) && bytes_of(a.triangles) == bytes_of(b.triangles));
}

Refusal name_taken(const std::string& name, const ObjectInfo* holder) {
  const std::string of =
      holder != nullptr && !holder->rare->scene.empty() ? " (of scene '" + holder->rare->scene + "')" : "";
  return {"the name '" + name + "' is taken" + of + "; names are unique in a world. Nothing was added"};
}

/// The entry for a part in a list ordered by part; null if it has none.
template <class Entry>
const Entry* entry_of(const std::vector<Entry>& entries, std::uint32_t part) {
  const auto found = std::lower_bound(entries.begin(), entries.end(), part,
                                      [](const Entry& entry, std::uint32_t number) { return entry.part < number; });
  return found == entries.end() || found->part != part ? nullptr : &*found;
}

}  // namespace

/// Objects with equal meshes share one mesh and one index, even if different publishers sent them.
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
    added = indexed_mesh(definition.shape.mesh, Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}}));
  }
  // Expired entries are removed each time the table has doubled: twenty thousand objects may come with one mesh each.
  if (meshes.size() >= meshes_looked_through_at) {
    std::erase_if(meshes, [](const auto& entry) { return entry.second.expired(); });
    meshes_looked_through_at = std::max<std::size_t>(64, 2 * meshes.size());
  }
  meshes.emplace(key, added);
  return added;
}

World::World(const WorldOptions& options) : state_(std::make_unique<State>(options)) {
  // Readers may come before the first step: publish an empty world.
  step(0, 0, {});
}

World::~World() = default;

IndexedScene World::index_scene(Scene scene, const BvhOptions& options) {
  const OwnFloatEnvironment own_floats;
  auto indexed = std::make_shared<StaticScene>();
  indexed->name = scene.name;
  indexed->mesh = std::move(scene.mesh);
  indexed->parts = scene.parts;
  indexed->tiles = scene.tiles;
  indexed->is_cut_off = std::ranges::any_of(scene.parts, [](const Part& part) { return !part.cut.is_whole(); });
  indexed->tree = index_of(indexed->mesh, scene.index, "the scene's mesh", options, indexed->warnings);
  scene.index = {};
  if (!scene.collapses.empty()) {
    indexed->levels = build_levels(indexed->mesh, indexed->tree, indexed->parts, scene.collapses, options.cancelled);
    scene.collapses = {};
  }
  BvhOptions quietly = options;
  quietly.progress = {};
  // objects that share a mesh share its index
  std::unordered_map<const TriangleMesh*, std::shared_ptr<const IndexedMesh>> of_mesh;
  for (SceneObject& object : scene.objects) {
    auto& mesh = indexed->object_meshes.emplace_back();
    if (!object.shape.mesh) continue;
    std::shared_ptr<const IndexedMesh>& known = of_mesh[object.shape.mesh.get()];
    if (known) {
      mesh = known;
      object.index = {};
      continue;
    }
    known = mesh = indexed_mesh(object.shape.mesh, index_of(*object.shape.mesh, object.index, "object " + object.name,
                                                            quietly, indexed->warnings));
    object.index = {};
  }
  return {.scene = std::move(scene), .geometry = std::move(indexed)};
}

std::optional<Refusal> World::refusal_of(const Scene& scene, bool replaces) const {
  const State& s = *state_;
  const auto leaves = [&](const ObjectInfo* info) {
    return replaces && info != nullptr && info->rare->scene == scene.name;
  };
  std::size_t loaded = s.rows.name_count();
  for (std::uint32_t slot = 0; replaces && slot < s.rows.size(); ++slot) loaded -= leaves(s.rows.info(slot)) ? 1 : 0;
  const std::size_t added = scene.parts.size() + scene.objects.size();
  if (loaded + added > s.options.max_objects) {
    return Refusal{"scene '" + scene.name + "' has " + std::to_string(added) + " objects; with the " +
                   std::to_string(loaded) + " loaded that is over the limit of " +
                   std::to_string(s.options.max_objects) + " (max_objects). Nothing was added"};
  }
  const auto taken = [&](const std::string& name) -> std::optional<Refusal> {
    const std::optional<ObjectId> owner = s.rows.find(name);
    if (!owner || leaves(s.rows.find(*owner))) return std::nullopt;
    return name_taken(name, s.rows.find(*owner));
  };
  for (const Part& part : scene.parts) {
    if (auto refusal = taken(part.name)) return refusal;
  }
  for (const SceneObject& object : scene.objects) {
    if (auto refusal = taken(object.name)) return refusal;
  }
  return std::nullopt;
}

std::variant<std::uint32_t, Refusal> World::add_scene(const IndexedScene& indexed) {
  State& s = *state_;
  const Scene& scene = indexed.scene;
  if (auto refusal = refusal_of(scene, false)) return std::move(*refusal);
  const auto add_part = [&](std::uint32_t part) {
    const ObjectId id = s.rows.take_slot();
    auto info = std::make_shared<ObjectInfo>();
    info->id = id;
    info->name = scene.parts[part].name;
    info->rare.edit().scene = scene.name;
    info->filter = scene.parts[part].filter;
    info->scene_part = part;
    info->part_triangles = scene.parts[part].triangle_count;
    info->rare.edit().cut = scene.parts[part].cut;
    if (const SolidPart* own = entry_of(indexed.geometry->solid_parts, part)) info->rare.edit().solid = own->solid;
    if (const WindingPart* own = entry_of(indexed.geometry->winding_parts, part))
      info->rare.edit().winding = own->winding;
    s.rows.put(std::move(info));
    indexed.geometry->part_objects[part] = id;
  };
  const std::vector<std::shared_ptr<const IndexedMesh>> meshes = std::move(indexed.geometry->object_meshes);
  const std::vector<std::shared_ptr<const SolidMesh>> solids = std::move(indexed.geometry->object_solids);
  const std::vector<std::shared_ptr<const WindingMesh>> windings = std::move(indexed.geometry->object_windings);
  SceneList::Scenes scenes(s.scenes.begin(), s.scenes.end());
  scenes.push_back(indexed.geometry);
  s.set_scenes(std::move(scenes));
  const auto add_object = [&](std::size_t i) {
    const SceneObject& object = scene.objects[i];
    [[maybe_unused]] const auto defined = define({.name = object.name,
                                                  .scene = scene.name,
                                                  .shape = object.shape,
                                                  .pose = object.pose,
                                                  .filter = object.filter,
                                                  .moving = scene.is_moving && !is_endless(object.shape),
                                                  .indexed = i < meshes.size() ? meshes[i] : nullptr,
                                                  .cut = object.cut,
                                                  .solid = i < solids.size() ? solids[i] : nullptr,
                                                  .winding = i < windings.size() ? windings[i] : nullptr,
                                                  .allowed = {scene.allowed_pairs, object.number}});
    assert(std::holds_alternative<ObjectId>(defined) && "names and limits were checked above");
  };
  indexed.geometry->part_objects.resize(scene.parts.size());
  const bool has_order = scene.frozen && !scene.frozen->order.empty();
  const std::size_t member_count = scene.parts.size() + scene.objects.size();
  for (std::size_t i = 0; i < member_count; ++i) {
    const std::size_t member = has_order ? scene.frozen->order[i] : i;
    if (member < scene.parts.size()) add_part(static_cast<std::uint32_t>(member));
    else add_object(member - scene.parts.size());
  }
  if (scene.frozen && scene.frozen->covers) state_covers(scene.name, *scene.frozen->covers);
  s.rows.place_all_movers_again();
  return static_cast<std::uint32_t>(member_count);
}

void World::State::set_scenes(SceneList::Scenes loaded) {
  scenes = SceneList(std::move(loaded));
  rows.note_scenes();
  apart.clear();
}

void World::State::gather_covers() {
  auto all = std::make_shared<std::vector<Aabb>>();
  if (!options.held) {
    for (const auto& [scene, boxes] : covers_of) all->insert(all->end(), boxes.begin(), boxes.end());
  } else if (!is_over) {
    all->push_back(*options.held);
  }
  covers = std::move(all);
}

void World::state_covers(std::string_view scene, std::span<const Aabb> boxes) {
  state_->covers_of.insert_or_assign(std::string(scene), std::vector<Aabb>(boxes.begin(), boxes.end()));
  state_->gather_covers();
}

void World::set_epoch(std::uint64_t epoch) { state_->options.epoch = epoch; }

void World::cover_nothing() {
  state_->is_over = true;
  state_->gather_covers();
}

std::uint32_t World::remove_scene(std::string_view name) {
  State& s = *state_;
  std::uint32_t removed_count = 0;
  for (std::uint32_t slot = 0; slot < s.rows.size(); ++slot) {
    const ObjectInfo* info = s.rows.info(slot);
    if (info == nullptr || info->rare->scene != name) continue;
    remove(info->id, EndReason::geometry_changed);
    ++removed_count;
  }
  SceneList::Scenes scenes(s.scenes.begin(), s.scenes.end());
  for (const auto& scene : scenes) {
    if (scene->name != name) continue;
    for (const ObjectId part : scene->part_objects) s.rows.free_slot(slot_of(part));
  }
  std::erase_if(scenes, [&](const auto& scene) { return scene->name == name; });
  s.set_scenes(std::move(scenes));
  if (const auto covers = s.covers_of.find(name); covers != s.covers_of.end()) {
    s.covers_of.erase(covers);
    s.gather_covers();
  }
  return removed_count;
}

std::variant<ObjectId, Refusal> World::define(const ObjectDefinition& definition) {
  const OwnFloatEnvironment own_floats;
  State& s = *state_;
  if (const auto taken = s.rows.find(definition.name)) return name_taken(definition.name, s.rows.find(*taken));
  if (is_full()) {
    return Refusal{"object '" + definition.name + "' is one more than the limit of " +
                   std::to_string(s.options.max_objects) + " objects (max_objects). Nothing was added"};
  }
  if (definition.moving && is_endless(definition.shape)) {
    return Refusal{"object '" + definition.name +
                   "' is a half-space that moves: it has no end, so it would be a candidate "
                   "for everything in every step; offered are those that do not move. Nothing was added"};
  }
  auto info = std::make_shared<ObjectInfo>();
  if (definition.shape.mesh) info->mesh = s.mesh_for(definition);
  const ObjectId id = s.rows.take_slot();
  info->id = id;
  info->name = definition.name;
  if (!definition.scene.empty()) info->rare.edit().scene = definition.scene;
  info->filter = definition.filter;
  info->moving = definition.moving;
  info->is_unknown = definition.shape.is_unknown;
  if (info->is_unknown) info->filter.mask = 0;
  info->lost_policy = definition.lost_policy;
  info->publisher = definition.publisher;
  info->primitives = s.primitives.shared(definition.shape.primitives);
  if (auto parts = index_parts(info->primitives)) info->rare.edit().parts = std::move(parts);
  if (definition.solid) info->rare.edit().solid = definition.solid;
  if (definition.winding) info->rare.edit().winding = definition.winding;
  if (definition.allowed.pairs) {
    info->rare.edit().allowed = definition.allowed;
    info->has_allowed_pairs = true;
  }
  if (definition.cut.piece_of) {
    info->rare.edit().cut = definition.cut;
    info->part_triangles = static_cast<std::uint32_t>(definition.shape.mesh->triangles.size());
  }
  const std::uint32_t source = definition.moving ? s.sources.add_object(definition.publisher) : Sources::kResting;
  const bool says_instants = definition.moving && s.sources[source].is_timed;
  const std::int64_t born_ns = says_instants ? s.sources[source].known_ns : kPosedAtStep;
  s.rows.put(std::move(info), definition.pose, source, born_ns);
  return id;
}

ObjectDefinition definition_of(const ObjectInfo& info, const Pose& pose) {
  return {.name = info.name,
          .scene = info.rare->scene,
          .shape = {.primitives = info.primitives.copy(),
                    .mesh = info.mesh ? info.mesh->mesh : nullptr,
                    .is_unknown = info.is_unknown},
          .pose = pose,
          .filter = info.filter,
          .moving = info.moving,
          .lost_policy = info.lost_policy,
          .publisher = info.publisher,
          .indexed = info.mesh,
          .cut = info.rare->cut,
          .solid = info.rare->solid,
          .winding = info.rare->winding,
          .allowed = info.rare->allowed};
}

bool World::remove(ObjectId id, EndReason reason) {
  State& s = *state_;
  if (s.rows.find(id) == nullptr) return false;
  s.removed.emplace_back(id, reason);
  s.forget_stale(id);
  const std::uint32_t source = s.rows.source(slot_of(id));
  if (source != Sources::kResting) s.sources.remove_object(source);
  s.has_lost_attached = s.has_lost_attached || s.attachments.find(id) != nullptr || s.attachments.is_parent(id);
  // A scene's triangles name their parts by slots for as long as the scene is loaded.
  s.rows.remove(id, s.rows.info(slot_of(id))->scene_part != kNoScenePart);
  return true;
}

bool World::State::move(ObjectId id, const Pose& pose, std::int64_t time_ns, bool teleport, bool is_streamed) {
  const std::uint32_t slot = slot_of(id);
  if (slot >= rows.size()) return false;
  const std::uint32_t source = rows.source(slot);
  PoseTime at{.time_ns = time_ns};
  if (source != Sources::kResting) {
    if (is_streamed) sources.note_streamed(source);
    const Source& of = sources[source];
    const std::int64_t settled_ns = of.settled_of(rows[slot].posed_ns);
    at.time_ns = is_streamed ? std::max(time_ns, settled_ns + 1) : of.admitted(time_ns);
    if (of.is_timed) at.since_ns = of.rested_until(at.time_ns);
    sources.note_posed(source, teleport || rows.is_new(slot) || at.since_ns >= at.time_ns);
  }
  if (!rows.move(id, pose, at, teleport ? Motion::placed : Motion::moved)) return false;
  if (!attachments.empty()) carry(id, pose, time_ns, teleport, is_streamed);
  return true;
}

bool World::move(ObjectId id, const Pose& pose, std::int64_t time_ns, bool teleport) {
  const OwnFloatEnvironment own_floats;
  const bool moved = state_->move(id, pose, time_ns, teleport, false);
  // The pose does not come from the lost publisher: the object is there now, with unknown speed.
  if (const auto found = state_->stale_places.find(id); found != state_->stale_places.end()) {
    StaleObject& stale = state_->stale_objects[found->second];
    stale.position = pose.position;
    stale.speed_mps = 0;
  }
  return moved;
}

void World::move(std::span<const ObjectId> ids, std::span<const Pose> poses, std::int64_t time_ns, bool teleport,
                 std::span<bool> moved, bool is_streamed) {
  constexpr std::size_t kAhead = 8;
  const OwnFloatEnvironment own_floats;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i + kAhead < ids.size()) state_->rows.prefetch(slot_of(ids[i + kAhead]));
    moved[i] = state_->move(ids[i], poses[i], time_ns, teleport, is_streamed);
  }
}

void World::set_gap(std::uint64_t publisher, std::int64_t gap_ns) { state_->sources.set_gap(publisher, gap_ns); }

bool World::advance(std::uint64_t publisher, std::int64_t time_ns, bool is_only_alive) {
  const std::optional<std::uint32_t> beginning = state_->sources.advance(publisher, time_ns, is_only_alive);
  if (beginning) state_->rows.begin(*beginning, state_->sources[*beginning].known_ns);
  return state_->sources.are_several();
}

void World::expect_objects(std::uint64_t publisher) { state_->sources.expect_objects(publisher); }

void World::lose(std::uint64_t publisher) { state_->sources.lose(publisher); }

bool World::is_full() const { return state_->rows.name_count() >= state_->options.max_objects; }

bool World::has_moved(ObjectId id) const {
  return slot_of(id) < state_->rows.size() && state_->rows.has_moved(slot_of(id));
}

void World::State::forget_stale(ObjectId id) {
  const auto found = stale_places.find(id);
  if (found == stale_places.end()) return;
  const std::size_t place = found->second;
  stale_places.erase(found);
  if (place + 1 < stale_objects.size()) {
    stale_objects[place] = stale_objects.back();
    stale_places[stale_objects[place].id] = place;
  }
  stale_objects.pop_back();
}

void World::set_stale(ObjectId id, bool is_stale) { state_->set_stale(id, is_stale); }

void World::State::set_stale(ObjectId id, bool is_stale) {
  if (rows.find(id) == nullptr) return;
  const ObjectRow& row = rows[slot_of(id)];
  if (row.is_stale == is_stale) return;
  rows.set_stale(slot_of(id), is_stale);
  lost.emplace_back(id, is_stale);
  attachments.for_each_child(id, [&](const AttachedObject& attached) { set_stale(attached.child, is_stale); });
  if (!is_stale) return forget_stale(id);
  const double motion_s = wire_contract::kNanosecond_s * static_cast<double>(row.posed_ns - row.posed_before_ns);
  const double travel_m = (row.pose.position - row.pose_before.position).norm();
  const bool has_speed = row.has_motion && row.posed_before_ns != kPosedAtStep && motion_s > 0;
  stale_places[id] = stale_objects.size();
  stale_objects.push_back({.id = id,
                           .position = row.pose.position,
                           .reach_m = reach_of(*rows.find(id)),
                           .speed_mps = has_speed ? travel_m / motion_s : 0,
                           .posed_ns = row.posed_ns});
}

std::variant<ObjectId, Refusal> World::add_fence(const FenceDefinition& definition) {
  const OwnFloatEnvironment own_floats;
  if (!state_->fences) state_->fences = std::make_unique<Fences>();
  return state_->fences->add(definition);
}

bool World::remove_fence(std::string_view name) { return state_->fences && state_->fences->remove(name); }

const Fences* World::fences() const { return state_->fences.get(); }

const std::vector<Event>& World::events() const { return state_->ledger.events(); }
const StepCost& World::cost() const { return state_->cost; }
const std::vector<OpenContact>& World::contacts() const { return state_->ledger.open(); }
std::size_t World::doubt_count() const { return state_->ledger.doubt_count(); }
std::uint64_t World::last_event_sequence() const { return state_->ledger.last_sequence(); }
std::int64_t World::settled_ns(std::int64_t now_ns) const { return state_->sources.settled_at_rest_ns(now_ns); }

void World::set_pair_rules(std::vector<PairRule> rules) {
  state_->pair_rules = rules.empty() ? nullptr : std::make_shared<const PairRules>(std::move(rules));
  state_->has_new_pair_rules = true;
}

std::vector<PairRule> World::pair_rules() const {
  return state_->pair_rules ? state_->pair_rules->rules() : std::vector<PairRule>();
}

std::optional<ObjectId> World::find(std::string_view name) const { return state_->rows.find(name); }
const ObjectInfo* World::info(ObjectId id) const { return state_->rows.find(id); }
const ObjectTable& World::objects() const { return state_->rows.table(); }
SnapshotRing::Lease World::newest() const { return state_->ring.newest(); }
const PoseMemory& World::memory() const { return state_->memory; }

}  // namespace collided::engine
