#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "collided/geometry.hpp"

namespace collided::client {

/// The convex hull of points, as outward-facing triangles of their indices; none if the points lie in one plane. A
/// point nearer to the hull than rounding errors counts as inside, since the hull is only drawn.
///
/// points  at most kMostHullPoints: time grows with the square; more throw std::runtime_error
/// source  de Berg, Cheong, van Kreveld, Overmars, "Computational Geometry", 3rd ed., 11.2, without its conflict lists
std::vector<std::array<std::uint32_t, 3>> drawn_hull(const std::vector<Vec3>& points);

/// The most points that a server accepts.
inline constexpr std::size_t kMostHullPoints = 4096;

}  // namespace collided::client
