#include "server/programs/files/points.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace collided::engine::files {

int points(const FileOptions& file) {
  LoadReport report;
  const Scene scene = load(file, report, {});
  std::size_t point_count = 0;
  std::size_t other_count = scene.mesh.triangles.size();
  for (const SceneObject& object : scene.objects) {
    other_count += object.shape.mesh ? 1 : 0;
    for (const Primitive& primitive : object.shape.primitives) {
      if (const auto* ball = std::get_if<Sphere>(&primitive)) {
        fmt::print("{} {} {}\n", shortest(ball->center.x()), shortest(ball->center.y()), shortest(ball->center.z()));
        ++point_count;
      } else {
        ++other_count;
      }
    }
  }
  if (point_count == 0) throw LoadError(fmt::format("{}: it holds no points", file.path));
  if (other_count > 0)
    fmt::print(stderr, "warning: {}: {} of its pieces that are no points are left out\n", file.path,
               grouped(other_count));
  return std::fflush(stdout) == 0 ? 0 : 2;
}

}  // namespace collided::engine::files
