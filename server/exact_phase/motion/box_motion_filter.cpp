#include "server/exact_phase/motion/box_motion_filter.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/overlap/box_lanes.hpp"

namespace collided::engine::kernel {
namespace {

/// Covers all roundings of placing, of the motion (kWayError, 96) and of the axis test (kSeparationError, 96),
/// relative to the largest coordinates and lengths: 2^13 roundings. No unit.
/// At zero, ExactBoxMotionFilter.ATouchIsNeverSurelyApart fails.
constexpr double kMotionSlack = 0x1p-40;
double largest(const Vec3& v) { return v.cwiseAbs().maxCoeff(); }

}  // namespace

MovingBox::MovingBox(const Box& own, const Frame& before, const Frame& now, double reach_m)
    : at_end(place(now, own)), at_start(at_end), travel(now.position - before.position) {
  error_m = kMotionSlack * (largest(now.position) + largest(before.position) + reach_m);
  if (before.rotation == now.rotation) {
    at_start.center -= travel;
    return;
  }
  at_start = place(before, own);
  // Two rotations move a point apart by at most the Frobenius norm of their difference times its distance from the
  // origin. The motion takes the shorter rotation, so the first frame is farthest from the last.
  const double turn = (now.rotation - before.rotation).norm();
  turn_m = turn * reach_m;
  // Rotating by an angle t changes the matrix by sqrt(8) sin(t / 2), and t is at most pi / sqrt(8) times that; an arc
  // leaves its chord by at most an eighth of reach t^2.
  const double turn_rad = 1.1108 * turn;
  bend_m = reach_m * turn_rad * turn_rad / 8;
}

bool surely_apart(const MovingBox& a, const MovingBox& b) {
  return parted_in_lanes(a.at_end, b.at_end,
                         {.a_at_start = a.at_start,
                          .b_at_start = b.at_start,
                          .travel = b.travel - a.travel,
                          .slack = kMotionSlack,
                          .error_m = a.error_m + b.error_m,
                          .turn_m = a.turn_m + b.turn_m,
                          .bend_m = a.bend_m + b.bend_m});
}

}  // namespace collided::engine::kernel
