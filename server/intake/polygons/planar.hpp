#pragma once

#include <array>

namespace collided::engine {

/// A point of a coordinate plane.
using PlanePoint = std::array<double, 2>;

/// Which way the path a, b, c turns: +1 to the left, -1 to the right, 0 not at all. Exact, except 0 where a product of
/// two coordinates leaves the range of double.
/// source    Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997
int turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c);

/// Whether the segments ab and cd cross at a point that is an end of neither. As exact as turn.
bool edges_cross(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d);

}  // namespace collided::engine
