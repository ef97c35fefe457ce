#include "server/exact_phase/motion/ball_motion_filter.hpp"

#include <algorithm>
#include <cmath>

#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {

bool surely_apart(const MovingSphere& mover, const Sphere& other) {
  const Vec3 from = mover.start - other.center;
  const Vec3 motion = mover.end - mover.start;
  const double travel_m2 = motion.squaredNorm();
  const double nearest = travel_m2 > 0 ? std::clamp(-from.dot(motion) / travel_m2, 0.0, 1.0) : 0.0;
  const double distance_m2 = (from + nearest * motion).squaredNorm();
  const double reach_m = mover.radius_m + other.radius_m;
  const double largest_m2 = from.squaredNorm() + travel_m2 + reach_m * reach_m;
  // Below this range squares may lose their digits, above it they are infinite; NaN fails the comparisons.
  return largest_m2 > kSmallestPlain && largest_m2 < kLargestPlain &&
         distance_m2 - reach_m * reach_m > kBallsApartSlack * largest_m2;
}

}  // namespace collided::engine::kernel
