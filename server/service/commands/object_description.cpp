#include "server/service/commands/object_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <variant>

#include "idl/described_json.hpp"
#include "server/service/commands/command_arguments.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/world/explain/ray_explanation.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {
namespace {

using nlohmann::json;

json describe(const Sphere& sphere) {
  return {{"sphere", {{"center", json_of(sphere.center)}, {"radius_m", sphere.radius_m}}}};
}

template <class Placed>
json placed(const Placed& solid) {
  return {
      {"center", json_of(solid.center)}, {"half_m", json_of(solid.half_m)}, {"rotation", json_of(Quat(solid.axes))}};
}
json describe(const Box& box) { return {{"box", placed(box)}}; }
json describe(const Ellipsoid& ellipsoid) { return {{"ellipsoid", placed(ellipsoid)}}; }

template <class Long>
json between_ends(const Long& solid) {
  return {{"a", json_of(solid.a)}, {"b", json_of(solid.b)}, {"radius_m", solid.radius_m}};
}
json describe(const Capsule& capsule) { return {{"capsule", between_ends(capsule)}}; }
json describe(const Cylinder& cylinder) { return {{"cylinder", between_ends(cylinder)}}; }

json describe(const Cone& cone) {
  return {{"cone", {{"apex", json_of(cone.apex)}, {"base", json_of(cone.base)}, {"radius_m", cone.radius_m}}}};
}

json describe(const Hull& hull) {
  return {{"hull", {{"vertices", hull.mesh->vertices.size()}, {"faces", hull.mesh->triangles.size()}}}};
}

json describe(const HalfSpace& half_space) {
  return {{"half_space", {{"point", json_of(half_space.point)}, {"normal", json_of(half_space.normal)}}}};
}

const StaticScene* scene_with(const Snapshot& snapshot, const ObjectInfo& info) {
  const auto found = std::find_if(snapshot.scenes.begin(), snapshot.scenes.end(),
                                  [&](const auto& scene) { return scene->name == info.rare->scene; });
  return found == snapshot.scenes.end() ? nullptr : found->get();
}

json part_bounds(const StaticScene& scene, const Part& part) {
  if (part.triangle_count == 0) return nullptr;
  Vec3 low = scene.mesh.triangle(part.first_triangle).a;
  Vec3 high = low;
  for (std::uint32_t i = 0; i < part.triangle_count; ++i) {
    const Triangle triangle = scene.mesh.triangle(part.first_triangle + i);
    for (const Vec3* corner : {&triangle.a, &triangle.b, &triangle.c}) {
      low = low.cwiseMin(*corner);
      high = high.cwiseMax(*corner);
    }
  }
  return {json_of(low), json_of(high)};
}

bool is_solid_by_winding(const StaticScene& scene, std::uint32_t part) {
  return std::any_of(scene.winding_parts.begin(), scene.winding_parts.end(),
                     [&](const WindingPart& one) { return one.part == part; });
}

std::uint64_t triangles_of(const ObjectInfo& info) {
  return info.mesh ? info.mesh->mesh->triangles.size() : info.part_triangles;
}

}  // namespace

json tiles_json(const TilesRead& tiles) {
  return {{"read", tiles.tiles}, {"of", tiles.tiles_of_file}, {"triangles_of_file", tiles.triangles_of_file}};
}

std::vector<CoveredBox> covered_boxes(const std::vector<Aabb>& boxes) {
  std::vector<CoveredBox> covered;
  for (const Aabb& box : boxes) covered.push_back({.low = box.low, .high = box.high});
  return covered;
}

ObjectId find_shown(const Snapshot& state, const std::string& name) {
  std::vector<std::string_view> others;
  for (const auto& info : state.objects) {
    if (!info) continue;
    if (info->name == name) return info->id;
    others.push_back(info->name);
  }
  throw BadCommand(unknown_object(name, others));
}

void require_whole(const Snapshot& state, ObjectId id, const std::string& command) {
  const ObjectInfo& info = *state.objects[slot_of(id)];
  if (info.rare->cut.is_whole()) return;
  throw BadCommand(fmt::format("{}: of {} this shard holds {} of {} triangles: one that it lacks may be nearer",
                               command, printable(info.name), triangles_of(info), info.rare->cut.whole_count),
                   "near and the questions for hits are answered; ask a server that holds all of it for this");
}

nlohmann::json bounds_of(const Snapshot& snapshot, const ObjectInfo& info) {
  if (info.scene_part != kNoTriangle) {
    const StaticScene* scene = scene_with(snapshot, info);
    return scene != nullptr ? part_bounds(*scene, scene->parts[info.scene_part]) : json(nullptr);
  }
  const Aabb bounds = snapshot.bounds(slot_of(info.id));
  json corners = json::array();
  // A number that is not finite becomes null.
  for (const Vec3& corner : {bounds.low, bounds.high}) corners.push_back({corner.x(), corner.y(), corner.z()});
  return corners;
}

ListedObject listed_object(const Snapshot& snapshot, const ObjectInfo& info, const std::string& publisher_name) {
  const std::uint32_t slot = slot_of(info.id);
  ListedObject object{.name = info.name,
                      .id = info.id,
                      .kind = std::string(kind_of(info)),
                      .moving = info.moving,
                      .scene = info.rare->scene,
                      .publisher = publisher_name,
                      .position = {},
                      .triangles = triangles_of(info),
                      .layers = info.filter.layers,
                      .stale = snapshot.stale[slot] != 0};
  if (info.scene_part == kNoTriangle) object.position = snapshot.poses[slot].position;
  if (snapshot.parents) {
    if (const auto parent = snapshot.parents->find(info.id); parent != snapshot.parents->end())
      object.attached_to = snapshot.objects[slot_of(parent->second)]->name;
  }
  return object;
}

ObjectDetails object_details(const Snapshot& snapshot, const ObjectInfo& info, const std::string& publisher_name,
                             std::int64_t now_ns) {
  const std::uint32_t slot = slot_of(info.id);
  ObjectDetails object;
  static_cast<ListedObject&>(object) = listed_object(snapshot, info, publisher_name);
  object.mask = info.filter.mask;
  object.group = info.filter.group;
  object.solid = info.rare->solid != nullptr || !info.primitives.empty();
  object.solid_by_winding = static_cast<bool>(info.rare->winding);
  if (info.scene_part != kNoTriangle) {
    const StaticScene* scene = scene_with(snapshot, info);
    if (scene && is_solid_by_winding(*scene, info.scene_part)) object.solid_by_winding = true;
    return object;
  }
  const Pose& pose = snapshot.poses[slot];
  object.pose = {.position = pose.position, .rotation = pose.rotation};
  if (snapshot.posed_ns[slot] > 0)
    object.age = std::chrono::nanoseconds(std::max<std::int64_t>(0, now_ns - snapshot.posed_ns[slot]));
  return object;
}

json shape_of(const ObjectInfo& info) {
  json shape = json::array();
  for (const Primitive& primitive : info.primitives)
    shape.push_back(std::visit([](const auto& one) { return describe(one); }, primitive));
  if (triangles_of(info) == 0) return shape;
  json mesh{{"triangles", triangles_of(info)}};
  if (info.mesh) mesh["vertices"] = info.mesh->mesh->vertices.size();
  if (!info.rare->cut.is_whole()) mesh["triangles_of_part"] = info.rare->cut.whole_count;
  shape.push_back({{"mesh", mesh}});
  return shape;
}

}  // namespace collided::engine::service
