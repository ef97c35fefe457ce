#pragma once

#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// What the double filter says about a ray's line and a triangle.
enum class SidesVerdict : int { miss, inside, unsure };

/// A ray's line against a triangle's edges in plain double, one edge per lane: ab with corner a, bc with b, ca with c,
/// and the last one again.
struct alignas(32) RaySides {
  double side[4];     // edge . (corner x direction), with the corner relative to the ray's start
  double edge2[4];    // squared edges
  double corner2[4];  // squared distances from the start to the corners
  double direction2;
};

/// SIMD, chosen at run time; every variant runs the same operations in the same order, so all give the same bits.
SidesVerdict ray_sides(const Ray& ray, const Triangle& triangle, RaySides& out);

}  // namespace collided::engine::kernel
