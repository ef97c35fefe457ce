#include "server/intake/polygons/polygon_counts.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "server/intake/polygons/crossing_polygon.hpp"
#include "server/intake/polygons/polygon_plane.hpp"

namespace collided::engine {

void PolygonCounts::measure(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices) {
  const Flatness found = flatness(corners, vertices);
  if (found.is_flat()) return;
  ++bent_count;
  most_bent_m = std::max(most_bent_m, found.off_plane_m);
}

void PolygonCounts::split(std::span<const std::uint32_t> corners, std::vector<Vec3>& vertices,
                          std::span<TriangleCorners> triangles) {
  const std::size_t vertex_count = vertices.size();
  const std::vector<TriangleCorners> lobes = split_at_crossings(corners, vertices);
  if (lobes.size() != triangles.size()) {
    vertices.resize(vertex_count);
    ++guessed_count;
    return;
  }
  std::copy(lobes.begin(), lobes.end(), triangles.begin());
  ++split_count;
  new_vertex_count += vertices.size() - vertex_count;
}

void PolygonCounts::add(const PolygonCounts& more) {
  split_count += more.split_count;
  guessed_count += more.guessed_count;
  bent_count += more.bent_count;
  most_bent_m = std::max(most_bent_m, more.most_bent_m);
  new_vertex_count += more.new_vertex_count;
}

void PolygonCounts::report(LoadReport& report) const {
  if (split_count > 0) {
    report.mended.push_back(
        fmt::format("{} polygons that cross themselves split at {} crossings; a guess at what was meant: each lobe is "
                    "kept, its edges run as in "
                    "the file, so lobes at a crossing face opposite ways",
                    split_count, new_vertex_count));
  }
  if (guessed_count > 0) {
    report.mended.push_back(
        fmt::format("{} polygons that cross or touch themselves cut into triangles by a guess", guessed_count));
  }
  if (bent_count > 0) {
    report.warnings.push_back(
        fmt::format("{} polygons are not flat, the worst by {:.3g} of the file's units; where they bend is decided by "
                    "how they are cut",
                    bent_count, most_bent_m));
  }
}

}  // namespace collided::engine
