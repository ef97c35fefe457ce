#pragma once

#include <optional>

#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// A lower bound on the distance of two triangles, 0 if none is known: the gap along the normals of both and along the
/// line between their middles.
double gap_at_least(const Triangle& a, const Triangle& b);

// Estimates of contact(a, b) for two overlapping triangles in plain double, at a tenth of its cost: of many pairs only
// the deepest is needed, or those whose normals point one way.

/// An upper bound on its depth_m, infinite out of range: the least push along the normals of both and the cross
/// products of their edges. Stops at the first push that gives a bound below enough_m.
double depth_at_most(const Triangle& a, const Triangle& b, double enough_m);

/// Its normal, off by less than kSureNormal in length, if one facet axis certainly has the least push, in one
/// direction; else nothing.
inline constexpr double kSureNormal = 0x1p-20;
std::optional<Vec3> sure_normal(const Triangle& a, const Triangle& b);

}  // namespace collided::engine::kernel
