#include "server/world/frozen.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace collided::engine {
namespace {

/// Pairs are written one by one: a scene that allows every pair is written up to this many objects, else its pairs are left out.
constexpr std::size_t kMostAllAllowed = 2'000;

std::optional<SolidBy> solid_of(const ObjectInfo& info) {
  if (info.rare->solid) return SolidBy::closing;
  if (info.rare->winding) return SolidBy::winding;
  return std::nullopt;
}

/// Collects objects in the order of their ids.
class Freezer {
 public:
  explicit Freezer(const Snapshot& state) : state_(state) {
    for (const auto& scene : state.scenes) scenes_.emplace(scene->name, scene.get());
  }

  Scene frozen() {
    std::vector<const ObjectInfo*> infos;
    for (const auto& info : state_.objects) {
      if (info) infos.push_back(info.get());
    }
    std::ranges::sort(infos, {}, &ObjectInfo::id);
    scene_.name = "snapshot";
    std::vector<std::pair<bool, std::uint32_t>> order;  // whether it is an object, and its place among those
    for (const ObjectInfo* info : infos) {
      const bool is_object = info->scene_part == kNoScenePart;
      order.emplace_back(is_object, is_object ? scene_.objects.size() : scene_.parts.size());
      if (is_object) add_object(*info);
      else add_part(*info);
    }
    allow_pairs();
    FrozenWorld& world = scene_.frozen.emplace();
    world.version = state_.version;
    world.world_time_ns = state_.world_time_ns;
    const auto first_object = static_cast<std::uint32_t>(scene_.parts.size());
    for (const auto& [is_object, place] : order) world.order.push_back(is_object ? first_object + place : place);
    if (std::ranges::is_sorted(world.order)) world.order.clear();
    if (state_.covers) world.covers = *state_.covers;
    note_lacks(world.lacks);
    return std::move(scene_);
  }

 private:
  void add_part(const ObjectInfo& info) {
    const StaticScene& from = *scenes_.at(info.rare->scene);
    const auto [known, is_new] = first_vertices_.try_emplace(&from, scene_.mesh.vertices.size());
    std::vector<Vec3>& vertices = scene_.mesh.vertices;
    if (is_new) vertices.insert(vertices.end(), from.mesh.vertices.begin(), from.mesh.vertices.end());
    const Part& part = from.parts[info.scene_part];
    const auto first = static_cast<std::uint32_t>(scene_.mesh.triangles.size());
    for (std::uint32_t i = 0; i < part.triangle_count; ++i) {
      TriangleCorners corners = from.mesh.triangles[part.first_triangle + i];
      for (std::uint32_t& corner : corners) corner += static_cast<std::uint32_t>(known->second);
      scene_.mesh.triangles.push_back(corners);
    }
    scene_.parts.push_back({info.name, first, part.triangle_count, info.filter, part.cut, solid_of(info)});
  }

  void add_object(const ObjectInfo& info) {
    const std::uint32_t slot = slot_of(info.id);
    const auto number = static_cast<std::uint32_t>(scene_.objects.size());
    Shape shape;
    shape.primitives = info.primitives.copy();
    if (info.mesh) shape.mesh = info.mesh->mesh;
    shape.is_unknown = info.is_unknown;
    scene_.objects.push_back(
        {info.name, std::move(shape), state_.poses[slot], info.filter, {}, info.rare->cut, number, solid_of(info)});
    const AllowedPartners& allowed = info.rare->allowed;
    if (allowed.pairs) partners_[allowed.pairs.get()].emplace(allowed.number, number);
  }

  /// The pairs of all scenes by the numbers that their objects have here.
  void allow_pairs() {
    std::vector<NumberPair> pairs;
    for (const auto& [allowed, number_of] : partners_) {
      if (allowed->is_every_pair() && number_of.size() > kMostAllAllowed) {
        ++lists_left_out_;
      } else if (allowed->is_every_pair()) {
        for (auto a = number_of.begin(); a != number_of.end(); ++a) {
          for (auto b = std::next(a); b != number_of.end(); ++b) pairs.emplace_back(a->second, b->second);
        }
      } else {
        for (const auto& [low, high] : allowed->pairs()) {
          const auto a = number_of.find(low);
          const auto b = number_of.find(high);
          if (a != number_of.end() && b != number_of.end()) pairs.emplace_back(a->second, b->second);
        }
      }
    }
    if (!pairs.empty()) scene_.allowed_pairs = std::make_shared<const AllowedPairs>(std::move(pairs));
  }

  void note_lacks(std::vector<std::string>& lacks) const {
    const auto lack = [&](std::size_t count, std::string_view one, std::string_view many) {
      if (count > 0) lacks.push_back(std::to_string(count) + ' ' + std::string(count == 1 ? one : many));
    };
    std::size_t levels = 0;
    for (const auto& scene : state_.scenes) levels += scene->levels.size();
    lack(state_.objects.counts().moving, "velocity", "velocities");
    lack(state_.stale_objects.size(), "mark that an object's publisher is lost",
         "marks that objects' publishers are lost");
    lack(state_.pair_rules ? state_.pair_rules->rules().size() : 0, "rule of allow and deny",
         "rules of allow and deny");
    lack(state_.parents ? state_.parents->size() : 0, "attachment", "attachments");
    lack(lists_left_out_, "robot's allowed pairs", "robots' allowed pairs");
    lack(levels, "simpler form of a mesh", "simpler forms of meshes");
  }

  const Snapshot& state_;
  Scene scene_;
  std::unordered_map<std::string_view, const StaticScene*> scenes_;
  std::unordered_map<const StaticScene*, std::size_t> first_vertices_;
  std::map<const AllowedPairs*, std::map<std::uint32_t, std::uint32_t>> partners_;  // number here by number there
  std::size_t lists_left_out_ = 0;
};

}  // namespace

std::variant<Scene, Refusal> frozen_scene(const Snapshot& state) {
  for (const auto& scene : state.scenes) {
    if (scene->is_cut_off)
      return Refusal{"this server holds only some triangles of parts of scene '" + scene->name +
                     "'. Nothing was written"};
  }
  return Freezer(state).frozen();
}

}  // namespace collided::engine
