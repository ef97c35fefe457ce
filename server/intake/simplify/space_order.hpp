#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/vector.hpp"

namespace collided::engine {

/// The numbers of the points in an order in which neighbours in space are mostly neighbours in the list.
/// cost    a sort; same input, same order
/// source  Morton, "A computer oriented geodetic data base", 1966
std::vector<std::uint32_t> space_order(std::span<const Vec3> points);

}  // namespace collided::engine
