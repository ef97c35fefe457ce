#pragma once

#include <optional>

#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// A lower bound on the distance of two triangles, 0 where none is known: the gap along the normals of both and along the
/// line between their middles.
double gap_at_least(const Triangle& a, const Triangle& b);

// What plain double tells of contact(a, b) of two triangles that overlap, at a tenth of its cost: of many pairs only the
// deepest is wanted, or those whose normals point one way.

/// An upper bound on its depth_m, out of range infinite: the least push along the normals of both and the cross products
/// of their edges. Stops at the first push that gives a bound below enough_m.
double depth_at_most(const Triangle& a, const Triangle& b, double enough_m);

/// Its normal, off by less than kSureNormal in length, where one facet axis is surely that of the least push, and one
/// way along it; else nothing.
inline constexpr double kSureNormal = 0x1p-20;
std::optional<Vec3> sure_normal(const Triangle& a, const Triangle& b);

}  // namespace collided::engine::kernel
