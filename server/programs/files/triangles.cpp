#include "server/programs/files/triangles.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace collided::engine::files {

int triangles(const FileOptions& file) {
  LoadReport report;
  const Scene scene = load(file, report, {});
  if (scene.mesh.triangles.empty()) throw LoadError(fmt::format("{}: it holds no triangles", file.path));
  if (!scene.objects.empty()) {
    fmt::print(stderr, "warning: {}: its {} objects that are not triangles are left out\n", file.path,
               grouped(scene.objects.size()));
  }
  for (const Vec3& vertex : scene.mesh.vertices)
    fmt::print("v {} {} {}\n", shortest(vertex.x()), shortest(vertex.y()), shortest(vertex.z()));
  for (const TriangleCorners& corner : scene.mesh.triangles)
    fmt::print("t {} {} {}\n", corner[0], corner[1], corner[2]);
  return std::fflush(stdout) == 0 ? 0 : 2;
}

}  // namespace collided::engine::files
