#pragma once

#include <optional>
#include <span>

#include "server/geometry/aabb.hpp"
#include "server/geometry/vector.hpp"

namespace collided::engine {

/// A point that is not covered and within a distance of one of the boxes; nothing if all of that is covered. Empty
/// boxes are near nothing.
///
/// covers  boxes in which the loaded geometry is complete
std::optional<Vec3> uncovered_near(std::span<const Aabb> boxes, double distance_m, std::span<const Aabb> covers);

}  // namespace collided::engine
