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

}  // namespace collided::engine
