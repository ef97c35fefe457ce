#pragma once

#include "server/exact_phase/kernels/nearest_kernel.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

// The refined nearest point of each set to a point. The gap may be negative for a sphere or capsule (minus the depth of
// the point). For a box the point must be outside.

NearestValue nearest_value(const Vec3& point, const Sphere& sphere);
NearestValue nearest_value(const Vec3& point, const Box& box);
NearestValue nearest_value(const Vec3& point, const Capsule& capsule);
NearestValue nearest_value(const Vec3& point, const Triangle& triangle);

/// A unit vector perpendicular to `along` by a fixed rule; +x if that is zero.
Vec3 any_normal(const Vec3& along);
/// The triangle's unit normal; for a triangle without area, perpendicular to its longest edge.
Vec3 any_normal(const Triangle& triangle);

/// Nearest point of the set grown by a further radius; the sum with its own is not rounded.
NearestValue nearest_value(const Vec3& point, double radius_m, const Sphere& sphere);
NearestValue nearest_value(const Vec3& point, double radius_m, const Box& box);
NearestValue nearest_value(const Vec3& point, double radius_m, const Capsule& capsule);
NearestValue nearest_value(const Vec3& point, double radius_m, const Triangle& triangle);

}  // namespace collided::engine::kernel
