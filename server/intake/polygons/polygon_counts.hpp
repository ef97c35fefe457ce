#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// Counts of special cases in cutting polygons into triangles, for the loading report.
struct PolygonCounts {
  std::uint64_t split_count = 0;       // polygons that cross themselves and were split there
  std::uint64_t guessed_count = 0;     // polygons that touch themselves or cross too often: cut by a guess
  std::uint64_t bent_count = 0;        // polygons whose corners are not in one plane
  double most_bent_m = 0;              // the largest distance of a corner from its plane, in the file's units
  std::uint64_t new_vertex_count = 0;  // made at crossings

  /// Counts a polygon of more than three corners if it is not flat.
  void measure(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices);
  /// Counts a polygon that was cut by a guess. If it crosses itself, replaces its triangles by a better guess.
  void split(std::span<const std::uint32_t> corners, std::vector<Vec3>& vertices, std::span<TriangleCorners> triangles);
  /// Adds the counts of another part of the file.
  void add(const PolygonCounts& more);
  /// Adds sentences to the report.
  void report(LoadReport& report) const;
};

}  // namespace collided::engine
