#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/intake/polygons/planar.hpp"

namespace collided::engine {

/// Two points of a polygon, by number: the edges that begin there cross or touch.
using PolygonFlaw = std::pair<std::uint32_t, std::uint32_t>;

/// Cuts a polygon with holes into triangles that turn left: points + 2 holes - 2 of them. Corners on straight edges are
/// kept, so a triangle of three corners on one line has no area.
///
/// points     the outer ring's, then those of the holes, each in either direction
/// ring_ends  index in the points at which each ring ends
/// returns    nothing: done. A flaw, and no triangles, if an edge or corner touches another one, a ring has no area, or
///            a hole is not inside
/// cost       O(n log n): about 3 us per corner for a million
/// source     monotone pieces by a sweep: Lee, Preparata, "Location of a point in a planar subdivision", 1977; Garey,
///            Johnson, Preparata, Tarjan, "Triangulating a simple polygon", 1978; crossings: Shamos, Hoey, "Geometric
///            intersection problems", 1976. Every sign is exact (planar.hpp).
std::optional<PolygonFlaw> triangulate_by_sweep(std::span<const PlanePoint> points,
                                                std::span<const std::uint32_t> ring_ends,
                                                std::vector<TriangleCorners>& triangles);

}  // namespace collided::engine
