#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

enum class PolygonKind {
  convex,    // cut as a fan from its first corner
  concave,   // cut by clipping ears, or a long one by a sweep
  crossing,  // crosses or touches itself: cut all the same, by a guess (split_at_crossings makes a better one)
  too_long,  // crosses or touches itself, with more than kMaxConcaveCorners corners: nothing was cut
};

/// Cuts a polygon of n >= 3 corners into n - 2 triangles, appended with the polygon's orientation.
///
/// The corners should lie in one plane; they are judged in the coordinate plane that sees most of the polygon, where
/// the coordinates stay as they are, so each sign is exact.
/// cost      O(n) convex; O(n^2) up to a hundred corners; O(n log n) beyond
/// source    Meisters, "Polygons have ears", 1975; sweep_triangulation.hpp
PolygonKind triangulate(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices,
                        std::vector<TriangleCorners>& triangles);

/// The same with holes: corners ring by ring, the outer one first, each ending where ring_ends says and in either
/// direction; n + 2 h - 2 triangles with the outer ring's orientation. `crossing`: rings cross, touch or lie outside, and
/// nothing was cut.
PolygonKind triangulate_with_holes(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> ring_ends,
                                   const std::vector<Vec3>& vertices, std::vector<TriangleCorners>& triangles);

}  // namespace collided::engine
