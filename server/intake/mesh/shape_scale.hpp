#pragma once

#include <string>

#include "server/geometry/shape.hpp"

namespace collided::engine {

/// Multiplies the shape about its frame's origin; each product is rounded, and the result is the exact input from then on.
///
/// factor   above 0 and finite. One for all axes suits every kind; others suit what stays of its kind: meshes, hulls,
///          and boxes and ellipsoids that lie along the axes.
/// returns  why it cannot be, which leaves the shape half done; empty: done
std::string scale(Shape& shape, const Vec3& factor);

}  // namespace collided::engine
