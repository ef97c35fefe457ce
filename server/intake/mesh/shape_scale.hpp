#pragma once

#include <string>

#include "server/geometry/shape.hpp"

namespace collided::engine {

/// Scales the shape about its frame's origin. Each product is rounded, and the result counts as the exact shape from
/// then on.
///
/// factor   one for each axis, above 0 and finite. Equal factors are possible for every kind of shape, unequal ones
///          only where the kind stays the same: for meshes, hulls, and boxes and ellipsoids that lie along the axes
/// returns  why it is not possible, with the shape in an unspecified state; empty: done
std::string scale(Shape& shape, const Vec3& factor);

/// Whether the point is beyond wire_contract::kMostCoordinate, as in "(1e+300, 0, 0) m, allowed are numbers up to 1e290";
/// empty: it is not.
std::string beyond_limit(const Vec3& point);
/// The same for all vertices of a mesh, and for everything that a shape is made of.
std::string beyond_limit(const TriangleMesh& mesh);
std::string beyond_limit(const Shape& shape);

}  // namespace collided::engine
