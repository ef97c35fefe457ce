#include "server/intake/mesh/sphere_mesh.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "server/intake/limits.hpp"

namespace collided::engine {
namespace {

/// cos and sin of a fraction of the full turn, mirrored from the first eighth so that opposite points are exact
/// mirror images and quarter turns are exact.
struct Direction {
  double cos;
  double sin;
};

Direction direction(unsigned step, unsigned steps) {
  const std::uint64_t eighths = 8 * std::uint64_t{step};
  const std::uint64_t octant = eighths / steps;
  const std::uint64_t turned = octant % 2 == 0 ? eighths - octant * steps : (octant + 1) * steps - eighths;
  const double angle = std::numbers::pi / 4 * (static_cast<double>(turned) / steps);
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  switch (octant % 8) {
    case 0: return {c, s};
    case 1: return {s, c};
    case 2: return {-s, c};
    case 3: return {-c, s};
    case 4: return {-c, -s};
    case 5: return {-s, -c};
    case 6: return {s, -c};
    default: return {c, -s};
  }
}

}  // namespace

TriangleMesh latitude_longitude_sphere(double radius_m, unsigned longitudes, unsigned latitudes) {
  const std::uint64_t triangle_count = std::uint64_t{2} * longitudes * (latitudes - std::uint64_t{1});
  if (!(radius_m >= 0 && std::isfinite(radius_m)) || longitudes < 3 || latitudes < 2 || triangle_count > kMaxVertices) {
    throw std::invalid_argument("sphere mesh: radius finite and >= 0, at least 3 longitudes and 2 latitudes");
  }
  TriangleMesh mesh;
  mesh.vertices.push_back({0, 0, radius_m});
  for (unsigned band = 1; band < latitudes; ++band) {
    const Direction down = direction(band, 2 * latitudes);  // from the north pole
    for (unsigned slice = 0; slice < longitudes; ++slice) {
      const Direction around = direction(slice, longitudes);
      mesh.vertices.push_back(radius_m * Vec3(down.sin * around.cos, down.sin * around.sin, down.cos));
    }
  }
  mesh.vertices.push_back({0, 0, -radius_m});
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  const auto ring = [&](unsigned band, unsigned slice) { return 1 + (band - 1) * longitudes + slice % longitudes; };
  mesh.triangles.reserve(triangle_count);
  for (unsigned slice = 0; slice < longitudes; ++slice) {
    mesh.triangles.push_back({0, ring(1, slice), ring(1, slice + 1)});
    for (unsigned band = 1; band + 1 < latitudes; ++band) {
      mesh.triangles.push_back({ring(band, slice), ring(band + 1, slice), ring(band + 1, slice + 1)});
      mesh.triangles.push_back({ring(band, slice), ring(band + 1, slice + 1), ring(band, slice + 1)});
    }
    mesh.triangles.push_back({last, ring(latitudes - 1, slice + 1), ring(latitudes - 1, slice)});
  }
  return mesh;
}

TriangleMesh box_mesh(const Vec3& low, const Vec3& high, Normals normals) {
  TriangleMesh mesh;
  for (unsigned i = 0; i < 8; ++i) {  // bit k of i: the high side of axis k
    mesh.vertices.emplace_back((i & 1) != 0 ? high[0] : low[0], (i & 2) != 0 ? high[1] : low[1],
                               (i & 4) != 0 ? high[2] : low[2]);
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  if (normals == Normals::inward) {
    for (TriangleCorners& corners : mesh.triangles) { std::swap(corners[1], corners[2]); }
  }
  return mesh;
}

}  // namespace collided::engine
