#include "server/world/query/pair_object.hpp"

#include <memory>

#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/query/stale_reach.hpp"

namespace collided::engine {
namespace {

std::shared_ptr<const TriangleMesh> mesh_of_part(const Snapshot& snapshot, const ObjectInfo& info, Deadline& deadline) {
  auto mesh = std::make_shared<TriangleMesh>();
  for (const auto& scene : snapshot.scenes) {
    if (info.scene_part >= scene->parts.size() || scene->part_objects[info.scene_part] != info.id) continue;
    const Part& part = scene->parts[info.scene_part];
    for (std::uint32_t i = 0; i < part.triangle_count && !deadline.is_over(); ++i) {
      const Triangle t = scene->mesh.triangle(part.first_triangle + i);
      const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
      mesh->vertices.insert(mesh->vertices.end(), {t.a, t.b, t.c});
      mesh->triangles.push_back({first, first + 1, first + 2});
    }
  }
  return mesh;
}

}  // namespace

PairObject::PairObject(const Snapshot& snapshot, ObjectId id, Deadline& deadline) {
  const ObjectInfo& info = *snapshot.objects[slot_of(id)];
  placed = {.info = &info,
            .frame = snapshot.frame(slot_of(id)),
            .bounds = snapshot.bounds(slot_of(id)),
            .pose = snapshot.has_given_poses ? &snapshot.poses[slot_of(id)] : nullptr};
  reach = placed.bounds;
  if (const std::optional<Aabb> region = unknown_region(snapshot, id)) {
    reach.extend(*region);
    is_stale = true;
  }
  if (info.scene_part == kNoScenePart) return;
  Shape shape;
  shape.mesh = mesh_of_part(snapshot, info, deadline);
  own = without_world(shape, [&deadline] { return deadline.is_over(); });
  if (info.rare->solid) own.rare.edit().solid = info.rare->solid;
  placed = {.info = &own, .frame = {}, .bounds = bounds_of(own, Frame())};
  reach = placed.bounds;
}

void PairObject::place_at(const Frame& elsewhere) {
  placed.frame = elsewhere;
  placed.pose = nullptr;
  placed.bounds = bounds_of(*placed.info, elsewhere);
}

}  // namespace collided::engine
