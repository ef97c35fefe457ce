#pragma once

#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// The side of the line o p on which q lies, in the plane of coordinates u and v: +1 left, -1 right, 0 on it, exact for
/// the given doubles; kTurnUnsure if plain double cannot decide.
///
/// promise  decides if the differences to o are doubles and no product leaves their range, even on the line: neighbours
///          in a flat mesh
/// cost     2 ns; 10 if the products differ by less than the error of a difference
/// threads  pure
/// source   filter: Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997
int sure_turn(const Vec3& o, const Vec3& p, const Vec3& q, int u, int v);
inline constexpr int kTurnUnsure = 2;

/// True if, seen along one axis, a line separates two triangles except for their shared part: the edge a.a = b.a to a.b
/// = b.b, the corner a.a = b.a, or nothing. Then they have nothing else in common. Finds all separate pairs in one
/// plane for which sure_turn decides.
///
/// returns  false: they may have more in common
/// cost     10, 20 and 30 ns
/// threads  pure
bool parted_but_for_edge(const Triangle& a, const Triangle& b);
bool parted_but_for_corner(const Triangle& a, const Triangle& b);
bool parted_in_projection(const Triangle& a, const Triangle& b);

}  // namespace collided::engine
