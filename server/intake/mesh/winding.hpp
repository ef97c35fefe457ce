#pragma once

#include <cstdint>
#include <vector>

#include "server/geometry/edge_table.hpp"

namespace collided::engine {

/// Which triangles are turned over against the others of their piece, where pieces hang together over edges of two
/// triangles.
struct Orientation {
  std::vector<std::uint32_t>
      flipped;  // ascending: of each piece the fewer, and where both are as many, not the first one's
  std::uint64_t unorientable_count =
      0;  // pieces where no turning makes all agree (a Moebius strip); none of theirs is flipped
};

/// cost      linear in edges but for the inverse of Ackermann's function
Orientation orientation_of(std::size_t triangle_count, const EdgeTable& table);

/// Points, as vertex numbers in ascending order, whose triangles fall into several fans: no edge at the point joins
/// them.
std::vector<std::uint32_t> pinched_points(const TriangleMesh& mesh, const EdgeTable& table,
                                          const std::vector<std::uint32_t>& point_of);

}  // namespace collided::engine
