#pragma once

#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::census {
using namespace engine;

// Tests as they stand in the literature, without a bound on their error: the census counts what that costs.

/// Moeller, Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997, no epsilon, in single precision.
bool plain_float_ray(const Ray& ray, const Triangle& triangle);
/// The same in double.
bool plain_double_ray(const Ray& ray, const Triangle& triangle);

/// Moeller, "A Fast Triangle-Triangle Intersection Test", 1997, in double with its epsilon of 1e-6.
bool moeller_triangles(const Triangle& a, const Triangle& b);

}  // namespace collided::census
