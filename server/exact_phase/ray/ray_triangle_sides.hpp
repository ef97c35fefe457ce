#pragma once

#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// What the plain filter says about a ray's line and a triangle.
enum class SidesVerdict : int { miss, inside, unsure };

/// A ray's line past a triangle's edges in plain double, lane by lane: ab with corner a, bc with b, ca with c, and the
/// third again.
struct alignas(32) RaySides {
  double side[4];     // e . (p x d): edge, corner seen from the start, direction
  double edge2[4];    // squared edges
  double corner2[4];  // squared distances from the start to the corners
  double direction2;
};

/// In SIMD, chosen at run time; the same operations in the same order on each, so the same bits.
SidesVerdict ray_sides(const Ray& ray, const Triangle& triangle, RaySides& out);

}  // namespace collided::engine::kernel
