#pragma once

#include <cstdint>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided {

/// For each vertex the first vertex with equal coordinates (itself where there is none before it). Equal means ==, so
/// 0 and -0 are one; nothing that is merely near is joined.
/// cost      one hash look-up a vertex
std::vector<std::uint32_t> first_equal_vertices(const std::vector<Vec3>& vertices);

/// Joins vertices with equal coordinates and drops none that a triangle uses; the triangles keep their points.
void weld_equal_vertices(TriangleMesh& mesh);

/// The triangles, ascending, whose three points an earlier triangle has as well, in any order.
/// first_equal  as first_equal_vertices gives it
std::vector<std::uint32_t> duplicate_triangles(const TriangleMesh& mesh, const std::vector<std::uint32_t>& first_equal);

}  // namespace collided
