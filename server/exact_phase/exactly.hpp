#pragma once

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/shapes.hpp"

/// The exact phase in rational arithmetic alone: the same questions as `overlaps`, `cast_ray` and `closest`, answered
/// without filters, expansions or early exits, so that an audit can compare some of the fast answers with a second
/// calculation. Decisions must be equal; two numbers must differ by no more than the sum of their bounds.
///
/// Rays against hulls, and nearest points of cylinders, cones, ellipsoids and hulls, have no second calculation: these
/// call the fast one.
///
/// returns  undecided only for boxes whose axes do not span space, and for round shapes that nearly touch
/// cost     3 to 300 us; allocates
/// threads  pure; ignores the thread's Precision
namespace collided::engine::exactly {

Decision overlaps(const Sphere& a, const Sphere& b);
Decision overlaps(const Sphere& a, const Box& b);
Decision overlaps(const Sphere& a, const Capsule& b);
Decision overlaps(const Sphere& a, const Triangle& b);
Decision overlaps(const Box& a, const Box& b);
Decision overlaps(const Box& a, const Capsule& b);
Decision overlaps(const Box& a, const Triangle& b);
Decision overlaps(const Capsule& a, const Capsule& b);
Decision overlaps(const Capsule& a, const Triangle& b);
Decision overlaps(const Triangle& a, const Triangle& b);
/// Accepts either order of the two kinds.
Decision overlaps(const Primitive& a, const Primitive& b);
Decision overlaps(const Primitive& a, const Triangle& b);

Decision cast_ray(const Ray& ray, const Triangle& triangle, RayHit& hit);
Decision cast_ray(const Ray& ray, const Sphere& sphere, RayHit& hit);
Decision cast_ray(const Ray& ray, const Box& box, RayHit& hit);
Decision cast_ray(const Ray& ray, const Capsule& capsule, RayHit& hit);
Decision cast_ray(const Ray& ray, const Primitive& primitive, RayHit& hit);

Closest closest(const Vec3& point, const Sphere& sphere);
Closest closest(const Vec3& point, const Box& box);
Closest closest(const Vec3& point, const Capsule& capsule);
Closest closest(const Vec3& point, const Triangle& triangle);
Closest closest(const Vec3& point, const Primitive& primitive);

}  // namespace collided::engine::exactly
