#include "server/exact_phase/ray/ray_box_kernel.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/exact_phase/ray/ray_round_kernel.hpp"

namespace collided::engine {

using kernel::cast_solid;
using kernel::WholeLadder;

ExactResult cast_ray(const Ray& ray, const Sphere& sphere, RayHit& hit) {
  return cast_solid<WholeLadder>(ray, sphere, hit);
}
ExactResult cast_ray(const Ray& ray, const Box& box, RayHit& hit) { return cast_solid<WholeLadder>(ray, box, hit); }
ExactResult cast_ray(const Ray& ray, const Capsule& capsule, RayHit& hit) {
  return cast_solid<WholeLadder>(ray, capsule, hit);
}

}  // namespace collided::engine
