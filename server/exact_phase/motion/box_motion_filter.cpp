#include "server/exact_phase/motion/box_motion_filter.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/overlap/box_pair.hpp"

namespace collided::engine::kernel {
namespace {

/// Covers all roundings of placing, of the motion (kWayError, 96) and of the axis test (kSeparationError, 96),
/// relative to the largest coordinates and lengths: 2^13 roundings. No unit.
/// At zero, ExactBoxMotionFilter.ATouchIsNeverSurelyApart fails.
constexpr double kMotionSlack = 0x1p-40;
/// In this range overflow and underflow cannot matter.
constexpr double kLargest = 0x1p100;

double largest(const Vec3& v) { return v.cwiseAbs().maxCoeff(); }

/// What separates two boxes along an axis all the way from start to end must leave more than `off`.
bool is_separated(double first, double last, double extent, double off) {
  return std::min(first, last) > extent + off || std::max(first, last) < -(extent + off);
}

double extent_along(const Triple& n, const Box& box) {
  double extent = 0;
  for (int i = 0; i < 3; ++i) {
    extent += box.half_m[i] * std::abs(dot(n, Triple{box.axes(0, i), box.axes(1, i), box.axes(2, i)}));
  }
  return extent;
}

}  // namespace

MovingBox::MovingBox(const Box& own, const Frame& before, const Frame& now, double reach_m)
    : at_end(place(now, own)), at_start(at_end), travel(now.position - before.position) {
  error_m = kMotionSlack * (largest(now.position) + largest(before.position) + reach_m);
  if (before.rotation == now.rotation) {
    at_start.center -= travel;
    return;
  }
  at_start = place(before, own);
  // Two rotations take a point at most as far apart as the Frobenius norm of their difference times its distance from
  // the origin, and the motion turns the short way, so no frame on the way is farther from the last than the first.
  const double turn = (now.rotation - before.rotation).norm();
  turn_m = turn * reach_m;
  // Rotating by an angle t changes the matrix by sqrt(8) sin(t / 2), and t is at most pi / sqrt(8) times that; an arc
  // leaves its chord by at most an eighth of reach t^2.
  const double turn_rad = 1.1108 * turn;
  bend_m = reach_m * turn_rad * turn_rad / 8;
}

bool surely_apart(const MovingBox& a, const MovingBox& b) {
  const BoxPair pair(a.at_end, b.at_end);
  // Where the centres would have been without turning, and where they were.
  const Triple unturned = pair.between - triple(b.travel - a.travel);
  const Triple before = triple(b.at_start.center) - triple(a.at_start.center);
  const double axis = pair.axis();
  const double reach = pair.reach() + unturned.largest() + before.largest();
  const auto in_range = [](double length) { return length > 1 / kLargest && length < kLargest; };
  if (!in_range(reach) || !in_range(axis)) return false;
  // |n| <= 2 sqrt(3) A^2.
  const double scale = 4 * axis * axis;
  const double error = (a.error_m + b.error_m + kMotionSlack * reach) * scale;
  const double turned = error + (a.turn_m + b.turn_m) * scale;
  const double bent = error + (a.bend_m + b.bend_m) * scale;
  const bool turns = a.turn_m + b.turn_m > 0;
  return !pair.for_each_axis([&](int, const Triple& n, double extent) {
    const double last = dot(pair.between, n);
    if (is_separated(dot(unturned, n), last, extent, turned)) return false;
    if (!turns || !is_separated(last, last, extent, bent)) return true;
    const double then = extent_along(n, a.at_start) + extent_along(n, b.at_start);
    return !is_separated(dot(before, n), last, std::max(extent, then), bent);
  });
}

}  // namespace collided::engine::kernel
