#include "server/intake/polygons/polygon_plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/intake/limits.hpp"

namespace collided::engine {
namespace {

struct EdgeNormals {
  Vec3 sum = Vec3::Zero();   // Newell's normal
  Vec3 seen = Vec3::Zero();  // areas in each projection; unlike in the sum, lobes that turn opposite ways do not cancel
};

EdgeNormals normals_of(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices) {
  EdgeNormals normals;
  const Vec3& origin = vertices[corners[0]];
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 from = vertices[corners[i]] - origin;
    const Vec3 to = vertices[corners[(i + 1) % corners.size()]] - origin;
    const Vec3 fan_triangle = from.cross(to);
    normals.sum += fan_triangle;
    normals.seen += fan_triangle.cwiseAbs();
  }
  return normals;
}

}  // namespace

std::vector<PlanePoint> flattened(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices) {
  const std::array<std::uint32_t, 1> one_ring{static_cast<std::uint32_t>(corners.size())};
  return flattened(corners, one_ring, vertices);
}

std::vector<PlanePoint> flattened(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> ring_ends,
                                  const std::vector<Vec3>& vertices) {
  const EdgeNormals normals = normals_of(corners.first(ring_ends[0]), vertices);
  int drop = 0;
  normals.seen.maxCoeff(&drop);
  const int u = (drop + 1) % 3;
  const int v = (drop + 2) % 3;
  std::vector<PlanePoint> points;
  points.reserve(corners.size());
  const double mirror = normals.sum[drop] < 0 ? -1 : 1;
  for (const std::uint32_t corner : corners) { points.push_back({mirror * vertices[corner][u], vertices[corner][v]}); }
  return points;
}

bool Flatness::is_flat() const { return off_plane_m <= kFlatEnough * size_m; }

Flatness flatness(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices) {
  const EdgeNormals normals = normals_of(corners, vertices);
  const double length = normals.sum.stableNorm();
  if (!(length > 0)) return {};
  const Vec3 normal = normals.sum / length;
  const Vec3& origin = vertices[corners[0]];
  double mean_m = 0;
  for (const std::uint32_t corner : corners) mean_m += normal.dot(vertices[corner] - origin);
  mean_m /= static_cast<double>(corners.size());
  Flatness found;
  for (const std::uint32_t corner : corners) {
    const Vec3 from_origin = vertices[corner] - origin;
    found.off_plane_m = std::max(found.off_plane_m, std::abs(normal.dot(from_origin) - mean_m));
    found.size_m = std::max(found.size_m, from_origin.norm());
  }
  return found;
}

}  // namespace collided::engine
