// Prepares two trees for the pair walk: derives the slacks that cover all its float roundings.

#include <algorithm>
#include <cmath>

#include "server/broad_phase/hierarchy/bvh_pairs.hpp"

namespace collided::engine::bvh {
namespace {

/// Smallest ratio of b to a: below it, double resolves little of b and cubes of floats are near the end of their range.
constexpr int kSmallestRatioExponent = -40;
constexpr double kLargestSlack = 0x1p20;
/// Bound on the difference of rotation^T rotation and the identity: far below what floats resolve.
constexpr double kOrthonormal = 0x1p-30;
/// Corners kept as edges are off by 5 * 2^-24 of the local unit (see triangle_boxes).
constexpr double kEdgeRounding = 0x1p-21;
/// Corners: their difference from the centre rounds by 2 u of its size; rotated, by 4 u more per term (the entry, the
/// product, two sums).
constexpr double kGrowOwn = 0x1p-22;
constexpr double kGrowTurned = 0x1p-21;
/// Boxes: middle and half round by 2 u, rotated by 4 u each, their sum by 2 u: 12 u of the reach, doubled (u = 2^-24).
constexpr double kGrowBox = 0x1p-19;

double row_sum(const Mat3& m) { return m.cwiseAbs().rowwise().sum().maxCoeff(); }

bool apart(const Layout& a, const Layout& b, const Mat3& to_a, const Vec3& center, double slack) {
  Vec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = static_cast<double>(b.root_low[axis]);
    high[axis] = static_cast<double>(b.root_high[axis]);
  }
  const Vec3 middle = center + to_a * (0.5 * (low + high));
  const Vec3 half = to_a.cwiseAbs() * (0.5 * (high - low));
  for (int axis = 0; axis < 3; ++axis) {
    if (middle[axis] - half[axis] - slack > static_cast<double>(a.root_high[axis])) return true;
    if (middle[axis] + half[axis] + slack < static_cast<double>(a.root_low[axis])) return true;
  }
  return false;
}

}  // namespace

PairCase prepare_pairs(const Layout& a, const Layout& b, const Mat3& rotation, const Vec3& position, double slack_m,
                       PairFrame& out) {
  const Mat3 skew = rotation.transpose() * rotation - Mat3::Identity();
  if (!(skew.cwiseAbs().maxCoeff() <= kOrthonormal)) return PairCase::odd;
  const int ratio_exponent = a.frame.scale_exponent - b.frame.scale_exponent;
  if (ratio_exponent < kSmallestRatioExponent || ratio_exponent > 0) return PairCase::odd;
  const double ratio = std::ldexp(1.0, ratio_exponent);
  const Vec3 turned = rotation * b.frame.origin;
  const Vec3 center = (turned + (position - a.frame.origin)) * a.frame.scale;
  const double sum_m = 2 * b.frame.origin.lpNorm<1>() + position.lpNorm<1>() + a.frame.origin.lpNorm<1>();
  const Mat3 to_a = ratio * rotation;
  const Mat3 to_b = rotation.transpose() / ratio;
  const double rows_a = row_sum(to_a);
  const double rows_b = row_sum(to_b);
  // The centre took eight roundings in double; its two floats add one of 2^-48.
  const double off = (slack_m * a.frame.scale + 0x1p-49 * sum_m * a.frame.scale + 0x1p-45) * (1 + 0x1p-20);
  if (!(off <= kLargestSlack) || !center.allFinite()) return PairCase::odd;
  const double root_slack = off + 0x1p-40 * (rows_a + center.lpNorm<1>());
  if (apart(a, b, to_a, center, root_slack)) return PairCase::apart;

  for (int axis = 0; axis < 3; ++axis) {
    out.center_high[axis] = static_cast<float>(center[axis]);
    out.center_low[axis] = static_cast<float>(center[axis] - static_cast<double>(out.center_high[axis]));
    for (int k = 0; k < 3; ++k) {
      out.to_a[axis][k] = static_cast<float>(to_a(axis, k));
      out.to_b[axis][k] = static_cast<float>(to_b(axis, k));
    }
  }
  const double reach = 2 * (rows_a + off);
  const double edges_a = a.has_corners ? 0 : kEdgeRounding;
  const double edges_b = b.has_corners ? 0 : kEdgeRounding;
  out.reach = round_up(reach);
  out.box_slack_a = round_up(off + kGrowBox * reach);
  out.box_slack_b = round_up(rows_b * (off + kGrowBox * reach));
  out.slack_a = round_up(off + edges_a + rows_a * (edges_b + kGrowTurned));
  out.slack_b = round_up(rows_b * (off + edges_a) + edges_b + kGrowOwn);
  out.grow_a = static_cast<float>(kGrowOwn);
  out.grow_b = round_up(kGrowTurned * rows_b);
  return PairCase::near;
}

}  // namespace collided::engine::bvh
