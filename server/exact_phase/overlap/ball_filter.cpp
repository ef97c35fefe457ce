#include "server/exact_phase/overlap/ball_filter.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/arithmetic/plain_range.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {

Decision quickly_overlaps(const Sphere& ball, const Box& box) {
  const Vec3 displacement = ball.center - box.center;
  const Vec3 local = (box.axes.transpose() * displacement).cwiseMax(-box.half_m).cwiseMin(box.half_m);
  const Vec3 gap = displacement - box.axes * local;  // from a point of the box, whatever the axes are
  const double gap_m2 = gap.squaredNorm();
  const double radius_m2 = ball.radius_m * ball.radius_m;
  const double largest_m2 = displacement.squaredNorm() + box.half_m.squaredNorm() + radius_m2;
  // Axes as they come from poses; the ladder handles those that do not span space.
  const bool spans = box.axes.squaredNorm() < 4 && std::abs(box.axes.determinant()) > 0.5;
  if (!in_plain_range(largest_m2) || !spans) return Decision::undecided;
  const double slack_m2 = kBallsApartSlack * largest_m2;
  if (gap_m2 < radius_m2 - slack_m2) return Decision::yes;
  // How far the sphere's centre is beyond the box along the gap, times the gap's length.
  const double beyond_m2 = gap.dot(displacement) - box.half_m.dot((box.axes.transpose() * gap).cwiseAbs()) - slack_m2;
  return beyond_m2 > 0 && beyond_m2 * beyond_m2 > radius_m2 * gap_m2 * (1 + kBallsApartSlack) ? Decision::no
                                                                                              : Decision::undecided;
}

Decision quickly_overlaps(const Sphere& ball, const Capsule& capsule) {
  const Vec3 from = capsule.a - ball.center;
  const Vec3 displacement = capsule.b - capsule.a;
  const double travel_m2 = displacement.squaredNorm();
  const double nearest = travel_m2 > 0 ? std::clamp(-from.dot(displacement) / travel_m2, 0.0, 1.0) : 0.0;
  const double reach_m = ball.radius_m + capsule.radius_m;
  const double largest_m2 = from.squaredNorm() + travel_m2 + reach_m * reach_m;
  if (!in_plain_range(largest_m2)) return Decision::undecided;
  const double over_m2 = (from + nearest * displacement).squaredNorm() - reach_m * reach_m;
  if (std::abs(over_m2) <= kBallsApartSlack * largest_m2) return Decision::undecided;
  return over_m2 < 0 ? Decision::yes : Decision::no;
}

}  // namespace collided::engine::kernel
