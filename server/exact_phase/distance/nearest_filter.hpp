#pragma once

#include <limits>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/geometry/shapes.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {

/// low2 <= the squared distance between a point and a triangle <= high2.
struct SquareBracket {
  double low2_m2;
  double high2_m2;
};

/// In plain double, proved by what it finds and not by how: a point of the triangle bounds the distance from above, a
/// plane before all three corners from below. Where that says nothing (coordinates out of range, slivers): 0 and
/// infinity.
///
/// error   high2 - low2 is about 2^-46 of the squared distance to the farthest corner, if the triangle is not a sliver
/// cost    about 20 ns; no allocation
/// source  nearest point: Ericson, "Real-Time Collision Detection", 2005, 5.1.5; plane: Gilbert, Johnson, Keerthi, "A
///         Fast Procedure for Computing the Distance Between Complex Objects", 1988, theorem 1
SquareBracket quick_square_distance(const Vec3& point, const Triangle& triangle);

/// The least squared distance to a corner, relative error 8 u; infinity for a corner that is not finite or squares that
/// leave the range.
double quick_nearest_corner2(const Vec3& point, const Triangle& triangle);

/// What the reported value of a depth does not exceed, when the depth itself does not exceed depth_m and the pair is of
/// that size: reported depths are sharp to kRefineRay of it, or as blunt as the thread has asked for.
inline double reported_at_most(double depth_m, double size_m) {
  if (precision.highest == Level::filter) return std::numeric_limits<double>::infinity();
  return depth_m + (2 * kRefineRay * size_m + precision.error_asked_m);
}

}  // namespace collided::engine::kernel
