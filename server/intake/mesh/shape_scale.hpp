#pragma once

#include <string>

#include "server/geometry/shape.hpp"

namespace collided::engine {

/// Scales the shape around its frame's origin. Each product is rounded, and the result counts as the exact shape from
/// then on.
///
/// factor   one for each axis, above 0 and finite. Equal factors are possible for every kind of shape, unequal ones
///          only if the kind stays the same: for meshes, hulls, and axis-aligned boxes and ellipsoids
/// returns  why it is not possible, with the shape in an unspecified state; empty: done
std::string scale(Shape& shape, const Vec3& factor);

/// A message if the point is beyond wire_contract::kMostCoordinate, as in "(1e+300, 0, 0) m, allowed are numbers up to
/// 1e290"; empty if it is not.
std::string beyond_limit(const Vec3& point);
/// Tests all vertices of a mesh, or everything that a shape consists of.
std::string beyond_limit(const TriangleMesh& mesh);
std::string beyond_limit(const Shape& shape);

}  // namespace collided::engine
