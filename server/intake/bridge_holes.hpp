#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/vector.hpp"

namespace collided {

enum class Bridging {
  done,
  no_bridge,  // a hole crosses the outer ring or lies outside of it
  too_long,   // more than kMaxBridgeTests pairs of edges would have to be compared
};

/// One ring of corners for a polygon with holes: each hole is entered and left along a bridge, an edge that is run
/// along both ways, so that cutting the ring into triangles cuts the polygon.
///
/// rings     the outer one, then the holes, each of at least 3 corners, in one plane; either way round
/// ring      the outer one with the bridges; left as it was unless done
/// cost      quadratic in the corners at worst, near linear where holes see a near corner
/// source    Eberly, "Triangulation by Ear Clipping", 2002, section 5, with the nearest visible corner
Bridging bridge_holes(std::span<const std::vector<std::uint32_t>> rings, const std::vector<Vec3>& vertices,
                      std::vector<std::uint32_t>& ring);

}  // namespace collided
