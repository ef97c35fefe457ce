#include "server/intake/held_parts.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

Aabb bounds_of(const TriangleMesh& mesh, const Part& part) {
  Aabb bounds;
  for (std::uint32_t i = 0; i < part.triangle_count; ++i) {
    for (const std::uint32_t corner : mesh.triangles[part.first_triangle + i]) bounds.extend(mesh.vertices[corner]);
  }
  return bounds;
}

Aabb bounds_of(const SceneObject& object) {
  const Frame frame = frame_of(object.pose);
  Aabb all;
  for (const Primitive& primitive : object.shape.primitives) all.extend(bounds(place(frame, primitive)));
  if (object.shape.mesh) {
    for (const Vec3& vertex : object.shape.mesh->vertices) all.extend(place(frame, vertex));
  }
  const double largest_m = std::max(all.low.cwiseAbs().maxCoeff(), all.high.cwiseAbs().maxCoeff());
  return grown(all, kBoundSlack * largest_m);
}

/// Moves the parts' triangles to the front, with the vertices that they use, in their order.
void keep_triangles_of(const std::vector<Part>& parts, TriangleMesh& mesh) {
  constexpr std::uint32_t kUnused = 0xffffffff;
  std::vector<std::uint32_t> place(mesh.vertices.size(), kUnused);
  TriangleMesh kept;
  for (const Part& part : parts) {
    for (std::uint32_t i = 0; i < part.triangle_count; ++i) {
      TriangleCorners corners = mesh.triangles[part.first_triangle + i];
      for (std::uint32_t& corner : corners) {
        if (place[corner] == kUnused) {
          place[corner] = static_cast<std::uint32_t>(kept.vertices.size());
          kept.vertices.push_back(mesh.vertices[corner]);
        }
        corner = place[corner];
      }
      kept.triangles.push_back(corners);
    }
  }
  mesh = std::move(kept);
}

}  // namespace

LeftOutOfScene leave_out_beyond(const Aabb& box, Scene& scene, bool is_moving) {
  LeftOutOfScene left_out;
  std::vector<Part> parts;
  for (const Part& part : scene.parts) {
    if (overlaps(bounds_of(scene.mesh, part), box)) parts.push_back(part);
  }
  left_out.parts = scene.parts.size() - parts.size();
  if (left_out.parts > 0) {
    keep_triangles_of(parts, scene.mesh);
    std::uint32_t first = 0;
    for (Part& part : parts) part.first_triangle = std::exchange(first, first + part.triangle_count);
    scene.parts = std::move(parts);
    scene.index = {};
    scene.collapses = {};
    if (scene.frozen) scene.frozen->order = {};
  }
  if (is_moving) return left_out;
  left_out.objects =
      std::erase_if(scene.objects, [&](const SceneObject& object) { return !overlaps(bounds_of(object), box); });
  if (left_out.objects > 0 && scene.frozen) scene.frozen->order = {};
  return left_out;
}

}  // namespace collided::engine
