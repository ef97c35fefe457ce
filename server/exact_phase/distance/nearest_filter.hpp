#pragma once

#include <limits>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/geometry/shapes.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {

/// low2_m2 <= the squared distance between a point and a triangle <= high2_m2.
struct SquareBracket {
  double low2_m2;
  double high2_m2;
};

/// Computed in plain double. The bounds hold however good the search is: a point of the triangle bounds the distance
/// from above, a plane in front of all three corners from below. If neither is certain (coordinates out of range,
/// slivers): 0 and infinity.
///
/// error   high2 - low2 is about 2^-46 of the squared distance to the farthest corner, unless the triangle is a sliver
/// cost    about 20 ns; no allocation
/// source  nearest point: Ericson, "Real-Time Collision Detection", 2005, 5.1.5; plane: Gilbert, Johnson, Keerthi, "A
///         Fast Procedure for Computing the Distance Between Complex Objects", 1988, theorem 1
SquareBracket quick_square_distance(const Vec3& point, const Triangle& triangle);

/// The triangle's approximate nearest point to the given one: for choosing a direction, not for bounds.
Vec3 quick_nearest_point(const Vec3& point, const Triangle& triangle);

/// The least squared distance to a corner, with relative error 8 u; infinity if a corner is not finite or squares leave
/// the range.
double quick_nearest_corner2(const Vec3& point, const Triangle& triangle);

/// A bound on the reported depth of a pair of that size whose true depth is at most depth_m: reported depths are
/// accurate to kRefineRay of the size, or to what the thread's precision allows.
inline double reported_at_most(double depth_m, double size_m) {
  if (precision.highest == Level::filter) return std::numeric_limits<double>::infinity();
  return depth_m + (2 * kRefineRay * size_m + precision.error_asked_m);
}

}  // namespace collided::engine::kernel
