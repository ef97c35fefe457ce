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

}  // namespace

MovingBox::MovingBox(const Box& own, const Frame& before, const Frame& now, double reach_m)
    : at_end(place(now, own)), travel(now.position - before.position) {
  // Two rotations take a point at most as far apart as the Frobenius norm of their difference times its distance from
  // the origin, and the motion turns the short way, so no frame on the way is farther from the last than the first.
  const double turn = before.rotation == now.rotation ? 0 : (now.rotation - before.rotation).norm();
  off_m = turn * reach_m + kMotionSlack * (largest(now.position) + largest(before.position) + reach_m);
}

bool surely_apart(const MovingBox& a, const MovingBox& b) {
  const BoxPair pair(a.at_end, b.at_end);
  const Triple before = pair.between - triple(b.travel - a.travel);
  const double axis = pair.axis();
  const double reach = pair.reach() + before.largest();
  const auto in_range = [](double length) { return length > 1 / kLargest && length < kLargest; };
  if (!in_range(reach) || !in_range(axis)) return false;
  // |n| <= 2 sqrt(3) A^2.
  const double off = (4 * (a.off_m + b.off_m) + kMotionSlack * reach) * axis * axis;
  return !pair.for_each_axis([&](int, const Triple& n, double extent) {
    const double first = dot(before, n);
    const double last = dot(pair.between, n);
    return !(std::min(first, last) > extent + off || std::max(first, last) < -(extent + off));
  });
}

}  // namespace collided::engine::kernel
