#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/vector.hpp"

namespace collided::engine {

/// The numbers of the points in an order in which points near each other in space are mostly near each other in the
/// list.
/// cost    that of a sort; the same input gives the same order
/// source  Morton, "A computer oriented geodetic data base", 1966
std::vector<std::uint32_t> space_order(std::span<const Vec3> points);

}  // namespace collided::engine
