#include "server/world/step/piece_points.hpp"

#include <algorithm>

#include "server/world/solids/within.hpp"

namespace collided::engine {
namespace {

/// Beyond this number, entries of removed objects are searched for.
constexpr std::size_t kMostKept = 1'024;

Aabb bounds_of_triangles(const TriangleMesh& mesh, std::uint32_t first, std::uint32_t count) {
  Aabb box;
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const std::uint32_t corner : mesh.triangles[i]) box.extend(mesh.vertices[corner]);
  }
  return box;
}

}  // namespace

std::span<const Vec3> PiecePoints::of(const ObjectInfo& info) {
  if (!is_bare_mesh(info)) {
    primitives_ = points_of_pieces(info);
    return primitives_;
  }
  MeshPoints& kept = meshes_[info.mesh.get()];
  // Another mesh may have been allocated at the same address.
  if (kept.mesh.lock() != info.mesh) {
    kept = {.mesh = info.mesh, .points = points_of_pieces(info)};
    forget_gone();
  }
  return meshes_[info.mesh.get()].points;
}

const PiecePoints::PartPoints& PiecePoints::of(const StaticScene& scene, std::uint32_t part) {
  if (parts_.size() > 2 * std::max(kMostKept, scene.parts.size())) parts_.clear();
  const auto [kept, is_new] = parts_.try_emplace(scene.part_objects[part]);
  if (is_new) {
    const Part& of = scene.parts[part];
    for (const std::uint32_t corner : corner_of_each_piece(scene.mesh, of.first_triangle, of.triangle_count))
      kept->second.points.push_back(scene.mesh.vertices[corner]);
    kept->second.bounds = bounds_of_triangles(scene.mesh, of.first_triangle, of.triangle_count);
  }
  return kept->second;
}

void PiecePoints::forget_gone() {
  if (meshes_.size() > kMostKept) std::erase_if(meshes_, [](const auto& kept) { return kept.second.mesh.expired(); });
}

}  // namespace collided::engine
