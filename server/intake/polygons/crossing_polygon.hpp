#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// Cuts a polygon that crosses itself at its crossings into lobes, and those into triangles: corners.size() - 2 of them.
/// What was meant is a guess: each lobe is kept, and its edges keep their direction, so that they still fit the polygons
/// beside them; lobes on the two sides of a crossing then face opposite ways.
///
/// vertices  get a new one for each crossing, in the middle of the two edges there
/// returns   nothing where no two edges cross (they may touch), where two only seem to and pass by each other in space by
///           more than kFlatEnough of the polygon's size, or there are more than kMaxCrossings crossings
/// cost      O(n^2) a crossing
std::vector<TriangleCorners> split_at_crossings(std::span<const std::uint32_t> corners, std::vector<Vec3>& vertices);

}  // namespace collided::engine
