#include <algorithm>
#include <cmath>
#include <limits>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {

double placing_error_along(const Ray& ray, const RayHit& hit, double placing_m, const Triangle* corners) {
  if (placing_m == 0) return 0;
  // Normal and direction have unit length up to a few roundings.
  const double steepness = std::abs(hit.normal.dot(ray.direction.stableNormalized())) - 8 * kRoundoff;
  if (!(steepness > 0)) return std::numeric_limits<double>::infinity();
  const double along_m = placing_m / steepness;
  // Within this depth of the solid, or over the triangle's height, the surface bends or rotates by far less than its
  // slope relative to the ray.
  double room_m = hit.exit_m - hit.distance_m;
  if (corners != nullptr) {
    const Vec3 edge[3] = {corners->b - corners->a, corners->c - corners->b, corners->a - corners->c};
    const double longest_m = std::max({edge[0].norm(), edge[1].norm(), edge[2].norm()});
    room_m = steepness * edge[0].cross(edge[1]).norm() / longest_m;
  }
  // If the room is this much larger, the neglected part is less than a quarter of the share that is added.
  constexpr double kMuchLarger = 0x1p12;
  constexpr double kNeglected = 0x1p-10;
  return along_m * kMuchLarger <= room_m ? along_m * (1 + kNeglected) : std::numeric_limits<double>::infinity();
}

}  // namespace collided::engine
