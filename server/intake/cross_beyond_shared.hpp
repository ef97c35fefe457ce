#pragma once

#include "server/geometry/mesh.hpp"
#include "server/geometry/orientation.hpp"

namespace collided {

/// Whether two triangles of one mesh have a point in common that is none of the corners or edges they share by number.
/// Triangles that share an edge do when they fold onto each other, those with the same three corners always.
///
/// returns  exact; true as well where exact arithmetic in double has no room, and for most triangles without area
/// threads  pure; no allocation
bool cross_beyond_shared(const std::vector<Vec3>& vertices, const TriangleCorners& one, const TriangleCorners& other);

/// The same with the plane through one's corners, for asking about one triangle and many others.
bool cross_beyond_shared(const std::vector<Vec3>& vertices, const TriangleCorners& one, const OrientedPlane& plane_of_one,
                         const TriangleCorners& other);

}  // namespace collided
