#include "server/exact_phase/overlap/capsule_filter.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/arithmetic/plain_range.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

/// Projections from a box to a segment and back; undecided pairs go to the ladder.
constexpr int kProjections = 6;

double nearest_on(const Vec3& point, const Vec3& start, const Vec3& displacement, double travel_m2) {
  return travel_m2 > 0 ? std::clamp((point - start).dot(displacement) / travel_m2, 0.0, 1.0) : 0.0;
}

/// gap: from a point of one core to a point of the other; beyond_m2: distance of the cores along it, times its length;
/// largest_m2: at least the square of any difference used for both.
Decision decide(const Vec3& gap, double beyond_m2, double reach_m, double largest_m2) {
  const double slack_m2 = kBallsApartSlack * largest_m2;
  const double gap_m2 = gap.squaredNorm();
  const double reach_m2 = reach_m * reach_m;
  if (gap_m2 < reach_m2 - slack_m2) return Decision::yes;
  const double surely_m2 = beyond_m2 - slack_m2;
  return surely_m2 > 0 && surely_m2 * surely_m2 > reach_m2 * gap_m2 * (1 + kBallsApartSlack) ? Decision::no
                                                                                             : Decision::undecided;
}

}  // namespace

Decision quickly_overlaps(const Capsule& a, const Capsule& b) {
  const Vec3 from = a.a - b.a;
  const Vec3 motion_a = a.b - a.a;
  const Vec3 motion_b = b.b - b.a;
  const double a_m2 = motion_a.squaredNorm();
  const double b_m2 = motion_b.squaredNorm();
  const double reach_m = a.radius_m + b.radius_m;
  const double largest_m2 = 4 * (from.squaredNorm() + a_m2 + b_m2) + reach_m * reach_m;
  if (!in_plain_range(largest_m2)) return Decision::undecided;
  const double across = motion_a.dot(motion_b);
  const double spread = a_m2 * b_m2 - across * across;
  const double along_a = motion_a.dot(from);
  const double along_b = motion_b.dot(from);
  double s = spread > 0 ? std::clamp((across * along_b - along_a * b_m2) / spread, 0.0, 1.0) : 0.0;
  const double t = b_m2 > 0 ? std::clamp((across * s + along_b) / b_m2, 0.0, 1.0) : 0.0;
  s = a_m2 > 0 ? std::clamp((across * t - along_a) / a_m2, 0.0, 1.0) : 0.0;
  const Vec3 gap = from + s * motion_a - t * motion_b;
  // The least reach of a's ends along the gap, less the largest of b's.
  const double beyond_m2 = gap.dot(from) + std::min(0.0, gap.dot(motion_a)) - std::max(0.0, gap.dot(motion_b));
  return decide(gap, beyond_m2, reach_m, largest_m2);
}

Decision quickly_overlaps(const Box& box, const Capsule& capsule) {
  const Vec3 start = capsule.a - box.center;
  const Vec3 displacement = capsule.b - capsule.a;
  const double travel_m2 = displacement.squaredNorm();
  const double radius_m2 = capsule.radius_m * capsule.radius_m;
  const double largest_m2 = 4 * (start.squaredNorm() + travel_m2 + box.half_m.squaredNorm()) + radius_m2;
  // Axes as they come from poses; the ladder handles those that do not span space.
  const bool spans = box.axes.squaredNorm() < 4 && std::abs(box.axes.determinant()) > 0.5;
  if (!in_plain_range(largest_m2) || !spans) return Decision::undecided;
  Vec3 on_box = Vec3::Zero();
  for (int i = 0; i < kProjections; ++i) {
    const Vec3 on_core = start + nearest_on(on_box, start, displacement, travel_m2) * displacement;
    const Vec3 local = (box.axes.transpose() * on_core).cwiseMax(-box.half_m).cwiseMin(box.half_m);
    on_box = box.axes * local;
    const Vec3 gap = on_core - on_box;
    const double beyond_m2 =
        gap.dot(start) + std::min(0.0, gap.dot(displacement)) - box.half_m.dot((box.axes.transpose() * gap).cwiseAbs());
    const Decision decision = decide(gap, beyond_m2, capsule.radius_m, largest_m2);
    if (decision != Decision::undecided) return decision;
  }
  return Decision::undecided;
}

}  // namespace collided::engine::kernel
