#pragma once

#include <cstdint>
#include <vector>

#include "server/geometry/edge_table.hpp"

namespace collided::engine {

/// Triangles that face the other way than the rest of their piece. Pieces are connected by edges of two triangles.
struct Orientation {
  std::vector<std::uint32_t>
      flipped;  // ascending: the minority of each piece; of equal halves, the one without the first triangle
  std::uint64_t unorientable_count =
      0;  // pieces that cannot be oriented (a Moebius strip); none of their triangles is listed
};

/// Finds these triangles.
/// cost      practically linear in the number of edges
Orientation orientation_of(std::size_t triangle_count, const EdgeTable& table);

/// Points whose triangles fall into several fans that no edge at the point connects, as vertex numbers in ascending
/// order.
std::vector<std::uint32_t> pinched_points(const TriangleMesh& mesh, const EdgeTable& table,
                                          const std::vector<std::uint32_t>& point_of);

}  // namespace collided::engine
