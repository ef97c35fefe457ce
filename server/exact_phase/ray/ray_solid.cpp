#include "server/exact_phase/ray/ray_box_kernel.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/exact_phase/ray/ray_round_kernel.hpp"

namespace collided::engine {

using kernel::cast_solid;
using kernel::WholeLadder;

namespace {

/// True if the ray's line misses the ball by more than double rounds: some forty roundings of terms whose sizes sum to
/// `size`. NaN and underflow prove nothing.
bool surely_passes_by(const Ray& ray, const Sphere& sphere) {
  constexpr double kRoundings = 0x1p-46;
  constexpr double kLeast = 0x1p-900;
  const Vec3 m = ray.origin - sphere.center;
  const double dd = ray.direction.squaredNorm();
  const double off = m.cross(ray.direction).squaredNorm();
  const double radius = sphere.radius_m * sphere.radius_m * dd;
  const double size = m.squaredNorm() * dd + radius;
  return off - radius > kRoundings * size + kLeast;
}

}  // namespace

ExactResult cast_ray(const Ray& ray, const Sphere& sphere, RayHit& hit) {
  if (surely_passes_by(ray, sphere)) return {Decision::no, Level::filter};
  return cast_solid<WholeLadder>(ray, sphere, hit);
}
ExactResult cast_ray(const Ray& ray, const Box& box, RayHit& hit) { return cast_solid<WholeLadder>(ray, box, hit); }
ExactResult cast_ray(const Ray& ray, const Capsule& capsule, RayHit& hit) {
  return cast_solid<WholeLadder>(ray, capsule, hit);
}

}  // namespace collided::engine
