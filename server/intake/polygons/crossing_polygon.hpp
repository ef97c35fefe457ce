#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// Cuts a polygon that crosses itself into lobes at its crossings, and the lobes into triangles, corners.size() - 2 in
/// all. The author's intention can only be guessed: each lobe is kept, and its edges keep their direction so that they
/// still fit the neighbouring polygons. So the lobes on the two sides of a crossing face opposite ways.
///
/// vertices  a new one is appended for each crossing, half-way between the two edges there
/// returns   nothing if no two edges cross (they may touch), if two edges cross only in projection and are farther
///           apart in space than kFlatEnough of the polygon's size, or if there are more than kMaxCrossings crossings
/// cost      O(n^2) per crossing
std::vector<TriangleCorners> split_at_crossings(std::span<const std::uint32_t> corners, std::vector<Vec3>& vertices);

}  // namespace collided::engine
