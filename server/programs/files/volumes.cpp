#include "server/programs/files/volumes.hpp"

#include <chrono>
#include <string>

#include <fmt/format.h>

#include "server/geometry/bounding_volumes.hpp"
#include "server/intake/readers/strips.hpp"

namespace collided::engine::files {
namespace {

template <class Make>
auto timed(const Make& make, double& ms) {
  const auto begin = std::chrono::steady_clock::now();
  auto made = make();
  ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return made;
}

void print_row(const std::string& name, const std::string& radius, double volume_m3, double ms) {
  fmt::print("  {:<28} {:>12} {:>12.5g} {:>9.3f}\n", name, radius, volume_m3, ms);
}

}  // namespace

void print_volumes(const Scene& scene) {
  const std::vector<Vec3>& points = scene.mesh.vertices;
  if (points.empty()) return;
  fmt::print("  {:<28} {:>12} {:>12} {:>9}\n", "VOLUME ABOUT THE VERTICES", "RADIUS m", "VOLUME m3", "TIME ms");
  double ms = 0;
  const Aabb box = timed([&] { return bounding_aabb(points); }, ms);
  print_row("box along the axes", "", volume(box), ms);
  const Box turned = timed([&] { return bounding_obb(points); }, ms);
  print_row("box along the mesh", "", volume(turned), ms);
  for (const int sides : {6, 14, 18, 26}) {
    const Kdop kdop = timed([&] { return bounding_kdop(points, kdop_normals(sides)); }, ms);
    print_row(fmt::format("k-DOP of {} sides", sides), "", volume(kdop), ms);
  }
  const auto print_sphere = [&](const char* name, Sphere (*make)(std::span<const Vec3>)) {
    const Sphere sphere = timed([&] { return make(points); }, ms);
    print_row(name, fmt::format("{:.6g}", sphere.radius_m), volume(sphere), ms);
  };
  print_sphere("sphere, half the diagonal", diagonal_sphere);
  print_sphere("sphere, farthest vertex", farthest_point_sphere);
  print_sphere("sphere, smallest", smallest_sphere);
}

void print_encodings(const Scene& scene) {
  if (scene.mesh.triangles.empty()) return;
  fmt::print("  {:<28} {:>12} {:>12}\n", "ENCODING", "BYTES", "A TRIANGLE");
  for (const EncodingSize& size : encoding_sizes(scene.mesh))
    fmt::print("  {:<28} {:>12} {:>12.1f}\n", size.name, size.bytes, size.bytes_a_triangle);
}

}  // namespace collided::engine::files
