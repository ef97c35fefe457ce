#include "server/world/groups/part_meshes.hpp"

#include "server/world/objects/indexed_mesh.hpp"

namespace collided::engine {

/// Forgets removed scenes, whose address another one may have by now.
PartMeshes::SceneParts& PartMeshes::parts_of_scene(const std::shared_ptr<const StaticScene>& scene) {
  std::erase_if(scenes_, [](const auto& known) { return known.second.scene.expired(); });
  SceneParts& parts = scenes_[scene.get()];
  parts.scene = scene;
  return parts;
}

/// Forgets everything if another part would exceed the limit: parts are built again on demand.
void PartMeshes::make_room(std::size_t triangles) {
  std::size_t kept = triangles;
  for (const auto& [scene, parts] : scenes_) {
    for (const auto& [number, mesh] : parts.meshes) kept += mesh->mesh->triangles.size();
  }
  if (kept <= kMostTriangles) return;
  for (auto& [scene, parts] : scenes_) parts.meshes.clear();
}

std::shared_ptr<const std::vector<Aabb>> PartMeshes::bounds_of(const std::shared_ptr<const StaticScene>& scene) {
  {
    const std::lock_guard lock(mutex_);
    if (const SceneParts& parts = parts_of_scene(scene); parts.bounds) return parts.bounds;
  }
  auto bounds = std::make_shared<std::vector<Aabb>>(scene->parts.size());
  for (std::size_t i = 0; i < scene->parts.size(); ++i) {
    const Part& part = scene->parts[i];
    for (std::uint32_t k = 0; k < part.triangle_count; ++k)
      (*bounds)[i].extend(engine::bounds(scene->mesh.triangle(part.first_triangle + k)));
  }
  const std::lock_guard lock(mutex_);
  return parts_of_scene(scene).bounds = bounds;
}

std::shared_ptr<const IndexedMesh> PartMeshes::mesh_of(const std::shared_ptr<const StaticScene>& scene,
                                                       std::uint32_t number, const std::function<bool()>& cancelled) {
  {
    const std::lock_guard lock(mutex_);
    const SceneParts& parts = parts_of_scene(scene);
    if (const auto known = parts.meshes.find(number); known != parts.meshes.end()) return known->second;
  }
  const Part& part = scene->parts[number];
  auto mesh = std::make_shared<TriangleMesh>();
  for (std::uint32_t i = 0; i < part.triangle_count && !cancelled(); ++i) {
    const Triangle corners = scene->mesh.triangle(part.first_triangle + i);
    const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
    mesh->vertices.insert(mesh->vertices.end(), {corners.a, corners.b, corners.c});
    mesh->triangles.push_back({first, first + 1, first + 2});
  }
  Bvh tree = Bvh::build(*mesh, {.threads = 1, .progress = {}, .cancelled = cancelled});
  std::shared_ptr<const IndexedMesh> indexed = indexed_mesh(mesh, std::move(tree));
  if (cancelled()) return indexed;
  const std::lock_guard lock(mutex_);
  make_room(part.triangle_count);
  return parts_of_scene(scene).meshes[number] = indexed;
}

}  // namespace collided::engine
