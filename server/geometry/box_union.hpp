#pragma once

#include <optional>
#include <span>

#include "server/geometry/aabb.hpp"

namespace collided::engine {

/// The part of a box, nearest to a point, that none of the other boxes contains; nothing if together they contain all
/// of it. Exact: every bound of a part is a bound of a given box. A box that needs more than some 100,000 comparisons,
/// or a thousand parts along one line, counts as not contained.
///
/// box      closed; may be flat or infinite, but not empty
/// threads  pure; no allocation
std::optional<Aabb> nearest_part_outside(const Aabb& box, std::span<const Aabb> others, const Vec3& from);

/// The point of a box that is nearest to another point.
inline Vec3 nearest_in(const Aabb& box, const Vec3& point) { return point.cwiseMax(box.low).cwiseMin(box.high); }

}  // namespace collided::engine
