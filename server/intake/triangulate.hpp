#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided {

enum class PolygonKind {
  convex,    // cut as a fan from its first corner
  concave,   // cut by clipping ears
  crossing,  // crosses or touches itself: cut all the same, by a guess
  too_long,  // concave with more than kMaxConcaveCorners corners: nothing was cut
};

/// Cuts a polygon of n >= 3 corners into n - 2 triangles, appended with the polygon's orientation.
///
/// The corners should lie in one plane; they are judged in the coordinate plane that sees most of the polygon, where
/// the coordinates stay as they are, so each sign is exact.
/// cost      O(n) convex, O(n r) for r reflex corners
/// source    Meisters, "Polygons have ears", 1975; Newell's normal: Sutherland, Sproull, Schumacker, 1974
PolygonKind triangulate(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices,
                        std::vector<TriangleCorners>& triangles);

}  // namespace collided
