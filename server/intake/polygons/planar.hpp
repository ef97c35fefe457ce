#pragma once

#include <array>

namespace collided::engine {

/// A point of a coordinate plane.
using PlanePoint = std::array<double, 2>;

/// Sign of the turn a, b, c: +1 to the left, -1 to the right, 0 on one line. Exact unless a product of two
/// coordinates leaves the range of double; there it is 0.
/// source    Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997
int turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c);

/// a b and c d go through each other, each at a point that is no end of it. As exact as turn.
bool edges_cross(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d);

}  // namespace collided::engine
