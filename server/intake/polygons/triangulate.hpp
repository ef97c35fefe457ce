#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// The kind of a polygon, and how it was cut.
enum class PolygonKind {
  convex,    // cut as a fan from its first corner
  concave,   // cut by clipping ears; many corners by a sweep
  crossing,  // crosses or touches itself; cut nevertheless, by a guess (split_at_crossings makes a better one)
  too_long,  // crosses or touches itself and has more than kMaxConcaveCorners corners; not cut
};

/// Cuts a polygon of n >= 3 corners into n - 2 triangles, appended with the polygon's orientation.
///
/// The corners should lie in one plane. They are projected to the coordinate plane in which the polygon appears
/// largest, which does not change coordinates, so orientation tests are exact.
/// cost      O(n) convex; O(n^2) up to a hundred corners; O(n log n) beyond
/// source    Meisters, "Polygons have ears", 1975; sweep_triangulation.hpp
PolygonKind triangulate(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices,
                        std::vector<TriangleCorners>& triangles);

/// Cuts a polygon with h holes into n + 2 h - 2 triangles with the outer ring's orientation.
///
/// corners    ring by ring, the outer one first, each in either direction
/// ring_ends  index in the corners at which each ring ends
/// returns    `crossing` if rings cross, touch or lie outside; then nothing was cut
PolygonKind triangulate_with_holes(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> ring_ends,
                                   const std::vector<Vec3>& vertices, std::vector<TriangleCorners>& triangles);

}  // namespace collided::engine
