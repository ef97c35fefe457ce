#include "server/exact_phase/motion/part_motion_filter.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/arithmetic/plain_range.hpp"
#include "server/exact_phase/arithmetic/triple.hpp"
#include "server/exact_phase/distance/nearest_filter.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

/// Roundings of a gap along a vector taken as exact, relative to the largest coordinates of differences between the
/// cores and to their sizes: a difference, a product of three terms and those with a box's axes, the vector's length
/// and a quotient leave less than 64 of sqrt(3) times those. No unit.
/// At zero, PartMotionFilters.ATouchOfALargeFaceIsNeverSurelyApart fails.
constexpr double kGapError = 128 * kRoundoff;

Triple column(const Mat3& m, int i) { return {m(0, i), m(1, i), m(2, i)}; }
Triple edge_of(const Core& core, int from, int to) { return triple(core.point[to]) - triple(core.point[from]); }
Triple normal_of(const Core& triangle) { return cross(edge_of(triangle, 0, 1), edge_of(triangle, 0, 2)); }

double size_of(const Core& core) {
  double size = core.radius_m;
  for (int i = 0; core.is_box && i < 3; ++i) size += core.half_m[i] * column(core.axes, i).largest();
  for (int i = 1; i < core.point_count; ++i) size = std::max(size, core.radius_m + edge_of(core, 0, i).largest());
  return size;
}

/// The reach of the core along n from its first point, without its ball.
double reach_along(const Core& core, const Triple& n) {
  double most = 0;
  for (int i = 1; i < core.point_count; ++i) most = std::max(most, dot(n, edge_of(core, 0, i)));
  for (int i = 0; core.is_box && i < 3; ++i) most += core.half_m[i] * std::abs(dot(n, column(core.axes, i)));
  return most;
}

/// Two cores at one instant.
struct PlacedCores {
  const Core& a;
  const Core& b;
  Triple between;  // from a's first point to b's
  double size;

  PlacedCores(const Core& of_a, const Core& of_b)
      : a(of_a),
        b(of_b),
        between(triple(of_b.point[0]) - triple(of_a.point[0])),
        size(between.largest() + size_of(of_a) + size_of(of_b)) {}

  /// Times |n|; b ahead.
  double gap_along(const Triple& n) const {
    return dot(n, between) - reach_along(a, n) - reach_along(b, {-n.x, -n.y, -n.z});
  }
};

}  // namespace

MotionPiece::MotionPiece(const BodyMotion& motion, const TimeSpan& span)
    : at_low(motion.at(span.low)),
      at_high(motion.at(span.high)),
      turn_rad(motion.turn_rad * (span.high - span.low)),
      is_at_rest(motion.turn_rad == 0 && motion.from.position == motion.to.position) {}

/// An arc leaves its chord by at most an eighth of reach * angle^2.
double MotionPiece::off_m(const BodyMotion& motion, double reach_m) const {
  return 2 * motion.error_m(reach_m) + reach_m * turn_rad * turn_rad / 8 * (1 + kBoundSlack);
}

bool surely_apart(const MovingCore& a, const MovingCore& b) {
  const PlacedCores low(a.at_low, b.at_low);
  const PlacedCores high(a.at_high, b.at_high);
  const double size = std::max(low.size, high.size);
  if (!in_plain_range(size * size)) return false;
  const double least_m = a.at_low.radius_m + b.at_low.radius_m + a.off_m + b.off_m + kGapError * size;
  const auto parts = [&](const Triple& n) {
    const double length2 = dot(n, n);
    if (!in_plain_range(length2)) return false;
    const double least = least_m * std::sqrt(length2) * (1 + kBoundSlack);
    return low.gap_along(n) > least && high.gap_along(n) > least;
  };
  const auto parts_either_way = [&](const Triple& n) {
    return parts(dot(n, high.between) < 0 ? Triple{-n.x, -n.y, -n.z} : n);
  };
  const Core& core_a = a.at_high;
  const Core& core_b = b.at_high;
  const bool a_is_triangle = core_a.point_count == 3;
  const bool b_is_triangle = core_b.point_count == 3;
  // From the nearest point of a triangle to the other's middle: the best direction for round and small parts.
  if (b_is_triangle && !a_is_triangle) {
    const Triangle other{core_b.point[0], core_b.point[1], core_b.point[2]};
    if (parts(triple(quick_nearest_point(core_a.point[0], other) - core_a.point[0]))) return true;
  } else if (a_is_triangle && !b_is_triangle) {
    const Triangle other{core_a.point[0], core_a.point[1], core_a.point[2]};
    if (parts(triple(core_b.point[0] - quick_nearest_point(core_b.point[0], other)))) return true;
  } else if (a_is_triangle && b_is_triangle) {
    const Vec3 middle_a = core_a.point[0] + (core_a.point[1] + core_a.point[2]);
    const Vec3 middle_b = core_b.point[0] + (core_b.point[1] + core_b.point[2]);
    if (parts(triple(middle_b - middle_a))) return true;
  }
  if (a_is_triangle && parts_either_way(normal_of(core_a))) return true;
  if (b_is_triangle && parts_either_way(normal_of(core_b))) return true;
  for (const Core* core : {&core_a, &core_b}) {
    for (int i = 0; core->is_box && i < 3; ++i) {
      if (parts_either_way(cross(column(core->axes, (i + 1) % 3), column(core->axes, (i + 2) % 3)))) return true;
    }
  }
  return false;
}

}  // namespace collided::engine::kernel
