#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/exact_phase/ray/ray_quadric_kernel.hpp"

namespace collided::engine {

using kernel::cast_quadric;
using kernel::WholeLadder;

ExactResult cast_ray(const Ray& ray, const Cylinder& cylinder, RayHit& hit) {
  return cast_quadric<WholeLadder>(ray, cylinder, hit);
}
ExactResult cast_ray(const Ray& ray, const Cone& cone, RayHit& hit) {
  return cast_quadric<WholeLadder>(ray, cone, hit);
}
ExactResult cast_ray(const Ray& ray, const Ellipsoid& ellipsoid, RayHit& hit) {
  return cast_quadric<WholeLadder>(ray, ellipsoid, hit);
}

}  // namespace collided::engine
