#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// What polygons needed on their way to triangles, for the loading report.
struct PolygonCounts {
  std::uint64_t split_count = 0;    // crossed themselves and were split there
  std::uint64_t guessed_count = 0;  // touch themselves, or cross too often: ears by a guess
  std::uint64_t bent_count = 0;     // whose corners are not in one plane
  double most_bent_m = 0;           // the farthest of them, in the file's units
  std::uint64_t new_vertex_count = 0;

  /// Of a polygon of more than three corners: whether it is flat.
  void measure(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices);
  /// Of a polygon that was cut by a guess: a better one in the place of its triangles, where it crosses itself.
  void split(std::span<const std::uint32_t> corners, std::vector<Vec3>& vertices, std::span<TriangleCorners> triangles);
  void add(const PolygonCounts& more);
  void report(LoadReport& report) const;
};

}  // namespace collided::engine
