#include "server/service/commands/object_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "server/service/commands/command_arguments.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/world/explain/ray_explanation.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {
namespace {

using nlohmann::json;

// -0 is reported as 0.
json describe(const Sphere& sphere) {
  return {{"sphere", {{"center", numbers(sphere.center)}, {"radius_m", sphere.radius_m}}}};
}

json describe(const Box& box) {
  return {{"box",
           {{"center", numbers(box.center)}, {"half_m", numbers(box.half_m)}, {"rotation", numbers(Quat(box.axes))}}}};
}

json describe(const Capsule& capsule) {
  return {{"capsule", {{"a", numbers(capsule.a)}, {"b", numbers(capsule.b)}, {"radius_m", capsule.radius_m}}}};
}

json describe(const Cylinder& cylinder) {
  return {{"cylinder", {{"a", numbers(cylinder.a)}, {"b", numbers(cylinder.b)}, {"radius_m", cylinder.radius_m}}}};
}

json describe(const Cone& cone) {
  return {{"cone", {{"apex", numbers(cone.apex)}, {"base", numbers(cone.base)}, {"radius_m", cone.radius_m}}}};
}

json describe(const Ellipsoid& ellipsoid) {
  return {{"ellipsoid",
           {{"center", numbers(ellipsoid.center)},
            {"half_m", numbers(ellipsoid.half_m)},
            {"rotation", numbers(Quat(ellipsoid.axes))}}}};
}

json describe(const Hull& hull) {
  return {{"hull", {{"vertices", hull.mesh->vertices.size()}, {"faces", hull.mesh->triangles.size()}}}};
}

json describe(const HalfSpace& half_space) {
  return {{"half_space", {{"point", numbers(half_space.point)}, {"normal", numbers(half_space.normal)}}}};
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
  return {numbers(low), numbers(high)};
}

bool is_solid_by_winding(const StaticScene& scene, std::uint32_t part) {
  return std::any_of(scene.winding_parts.begin(), scene.winding_parts.end(),
                     [&](const WindingPart& one) { return one.part == part; });
}

std::uint64_t triangles_of(const ObjectInfo& info) {
  return info.mesh ? info.mesh->mesh->triangles.size() : info.part_triangles;
}

}  // namespace

json numbers(const Quat& rotation) {
  return {rotation.w() + 0.0, rotation.x() + 0.0, rotation.y() + 0.0, rotation.z() + 0.0};
}

json numbers(const Vec3& vector) { return {vector.x() + 0.0, vector.y() + 0.0, vector.z() + 0.0}; }

json tiles_json(const TilesRead& tiles) {
  return {{"read", tiles.tiles}, {"of", tiles.tiles_of_file}, {"triangles_of_file", tiles.triangles_of_file}};
}

json covers_json(const std::vector<Aabb>& boxes) {
  json list = json::array();
  const auto number = [](double x) { return std::isinf(x) ? json(x > 0 ? "inf" : "-inf") : json(x); };
  for (const Aabb& box : boxes) {
    json corners = json::array();
    for (const Vec3* corner : {&box.low, &box.high}) {
      for (const double x : *corner) corners.push_back(number(x));
    }
    list.push_back(std::move(corners));
  }
  return list;
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
  return {numbers(bounds.low), numbers(bounds.high)};
}

nlohmann::json describe_briefly(const Snapshot& snapshot, const ObjectInfo& info, const std::string& publisher_name) {
  const std::uint32_t slot = slot_of(info.id);
  const bool placed = info.scene_part == kNoTriangle;
  json object{{"name", info.name},
              {"id", info.id},
              {"kind", kind_of(info)},
              {"moving", info.moving},
              {"scene", info.rare->scene},
              {"publisher", publisher_name},
              {"position", placed ? numbers(snapshot.poses[slot].position) : json(nullptr)},
              {"triangles", triangles_of(info)},
              {"layers", info.filter.layers},
              {"stale", snapshot.stale[slot] != 0}};
  if (snapshot.parents) {
    if (const auto parent = snapshot.parents->find(info.id); parent != snapshot.parents->end())
      object["attached_to"] = snapshot.objects[slot_of(parent->second)]->name;
  }
  return object;
}

void describe_fully(const Snapshot& snapshot, const ObjectInfo& info, std::int64_t now_ns, nlohmann::json& object) {
  const std::uint32_t slot = slot_of(info.id);
  object["mask"] = info.filter.mask;
  object["group"] = info.filter.group;
  json shape = json::array();
  for (const Primitive& primitive : info.primitives) {
    shape.push_back(std::visit([](const auto& one) { return describe(one); }, primitive));
  }
  if (triangles_of(info) > 0) {
    json mesh{{"triangles", triangles_of(info)}};
    if (info.mesh) mesh["vertices"] = info.mesh->mesh->vertices.size();
    if (!info.rare->cut.is_whole()) mesh["triangles_of_part"] = info.rare->cut.whole_count;
    shape.push_back({{"mesh", mesh}});
  }
  object["shape"] = shape;
  object["solid"] = info.rare->solid != nullptr || !info.primitives.empty();
  if (info.rare->winding) object["solid_by"] = "winding";
  if (info.scene_part != kNoTriangle) {
    const StaticScene* scene = scene_with(snapshot, info);
    if (scene && is_solid_by_winding(*scene, info.scene_part)) object["solid_by"] = "winding";
    object["bounds"] = bounds_of(snapshot, info);
    return;
  }
  const Pose& pose = snapshot.poses[slot];
  object["pose"] = numbers(pose.position);
  for (const json& number : numbers(pose.rotation)) object["pose"].push_back(number);
  object["bounds"] = bounds_of(snapshot, info);
  if (snapshot.posed_ns[slot] > 0) object["age_ns"] = std::max<std::int64_t>(0, now_ns - snapshot.posed_ns[slot]);
}

}  // namespace collided::engine::service
