#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/exact_phase/overlap/box_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/plain_range.hpp"
#include "server/exact_phase/overlap/box_lanes.hpp"

// Without fused operations, so that every instruction set decides the same pairs; the bounds assume BoxPair's order of
// operations.
HWY_BEFORE_NAMESPACE();
namespace collided::engine::kernel::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kAxes = 4;  // three, and the first once more
using AxisDoubles = hn::CappedTag<double, kAxes>;
using AxisLanes = hn::Vec<AxisDoubles>;
using AxisMask = hn::Mask<AxisDoubles>;
constexpr AxisDoubles kAxisDoubles;
constexpr int kAxisStride = static_cast<int>(hn::MaxLanes(kAxisDoubles));
/// Axes in five groups of four: a's faces, b's faces, and each edge of a crossed with those of b.
constexpr int kGroups = 5;

struct Lanes3 {
  AxisLanes x, y, z;
};

HWY_INLINE Lanes3 spread(const double (&v)[3]) {
  return {hn::Set(kAxisDoubles, v[0]), hn::Set(kAxisDoubles, v[1]), hn::Set(kAxisDoubles, v[2])};
}
HWY_INLINE AxisLanes dot(const Lanes3& a, const Lanes3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE AxisLanes over(const Lanes3& a, const Lanes3& b) { return hn::Abs(dot(a, b)); }
HWY_INLINE Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE AxisMask is_same(const Lanes3& a, const Lanes3& b) {
  return hn::And(hn::And(hn::Eq(a.x, b.x), hn::Eq(a.y, b.y)), hn::Eq(a.z, b.z));
}
HWY_INLINE AxisMask is_same_line(const Lanes3& a, const Lanes3& b) {
  return hn::Or(is_same(a, b), is_same(a, {hn::Neg(b.x), hn::Neg(b.y), hn::Neg(b.z)}));
}

/// A box's axes by coordinate, cyclically repeated for lanes that begin at any of them.
struct BoxColumns {
  double axis[3][6];    // coordinate, axis with repetition
  double half_m[6];     // with repetition
  double normal[3][3];  // face, coordinate
  double volume;
  double largest;

  HWY_INLINE explicit BoxColumns(const Box& box) {
    largest = 0;
    for (int c = 0; c < 3; ++c) {
      for (int i = 0; i < 3; ++i) {
        axis[c][i] = axis[c][i + 3] = box.axes(c, i);
        largest = std::max(largest, std::abs(axis[c][i]));
      }
    }
    for (int i = 0; i < 3; ++i) {
      half_m[i] = half_m[i + 3] = box.half_m[i];
      for (int c = 0; c < 3; ++c) {
        const int c1 = (c + 1) % 3;
        const int c2 = (c + 2) % 3;
        normal[i][c] = axis[c1][i + 1] * axis[c2][i + 2] - axis[c2][i + 1] * axis[c1][i + 2];
      }
    }
    volume = std::abs((axis[0][0] * normal[0][0] + axis[1][0] * normal[0][1]) + axis[2][0] * normal[0][2]);
  }
  HWY_INLINE Lanes3 axes_from(int first) const {
    return {hn::LoadU(kAxisDoubles, axis[0] + first), hn::LoadU(kAxisDoubles, axis[1] + first),
            hn::LoadU(kAxisDoubles, axis[2] + first)};
  }
  HWY_INLINE Lanes3 axis_spread(int i) const { return spread({axis[0][i], axis[1][i], axis[2][i]}); }
  HWY_INLINE AxisLanes half_from(int first) const { return hn::LoadU(kAxisDoubles, half_m + first); }
  HWY_INLINE AxisLanes half_spread(int i) const { return hn::Set(kAxisDoubles, half_m[i % 3]); }
};

struct BoxPairLanes {
  BoxColumns a;
  BoxColumns b;
  double between[3];
  double axis;   // largest coordinate of an axis
  double reach;  // upper bound on coordinates of differences between two points of the pair

  HWY_INLINE BoxPairLanes(const Box& first, const Box& second)
      : a(first),
        b(second),
        between{second.center[0] - first.center[0], second.center[1] - first.center[1],
                second.center[2] - first.center[2]},
        axis(std::max(a.largest, b.largest)) {
    const double apart = std::max({std::abs(between[0]), std::abs(between[1]), std::abs(between[2])});
    reach = apart + axis * (first.half_m.sum() + second.half_m.sum());
  }

  /// Calls visit(group, first lane, n, extent, excluded) for four axes at a time, until it returns false.
  template <class Visit>
  HWY_INLINE bool for_each_group(Visit&& visit) const {
    for (int first = 0; first < kAxes; first += kAxisStride) {
      if (!faces(a, b, 0, first, visit) || !faces(b, a, 1, first, visit)) return false;
    }
    for (int first = 0; first < kAxes; first += kAxisStride) {
      if (!edges(first, visit)) return false;
    }
    return true;
  }

 private:
  template <class Visit>
  static HWY_INLINE bool faces(const BoxColumns& own, const BoxColumns& other, int group, int first, Visit&& visit) {
    const Lanes3 n = cross(own.axes_from(first + 1), own.axes_from(first + 2));
    AxisLanes reach_over = hn::Mul(other.half_spread(0), over(other.axis_spread(0), n));
    reach_over = hn::Add(reach_over, hn::Mul(other.half_spread(1), over(other.axis_spread(1), n)));
    reach_over = hn::Add(reach_over, hn::Mul(other.half_spread(2), over(other.axis_spread(2), n)));
    const AxisLanes own_reach = hn::Mul(own.half_from(first), hn::Set(kAxisDoubles, own.volume));
    const AxisLanes zero = hn::Zero(kAxisDoubles);
    return visit(group, first, n, hn::Add(own_reach, reach_over), hn::Gt(zero, zero));
  }
  template <class Visit>
  HWY_INLINE bool edges(int first, Visit&& visit) const {
    const Lanes3 b0 = b.axes_from(first);
    const Lanes3 b1 = b.axes_from(first + 1);
    const Lanes3 b2 = b.axes_from(first + 2);
    const Lanes3 normal1 = cross(b2, b0);
    const Lanes3 normal2 = cross(b0, b1);
    const AxisLanes b_over_a[3] = {over(b0, spread(a.normal[0])), over(b0, spread(a.normal[1])),
                                   over(b0, spread(a.normal[2]))};
    for (int i = 0; i < 3; ++i) {
      const int i1 = (i + 1) % 3;
      const int i2 = (i + 2) % 3;
      const Lanes3 edge = a.axis_spread(i);
      const AxisLanes extent_a =
          hn::Add(hn::Mul(a.half_spread(i1), b_over_a[i2]), hn::Mul(a.half_spread(i2), b_over_a[i1]));
      const AxisLanes extent_b = hn::Add(hn::Mul(b.half_from(first + 1), over(edge, normal2)),
                                         hn::Mul(b.half_from(first + 2), over(edge, normal1)));
      if (!visit(2 + i, first, cross(edge, b0), hn::Add(extent_a, extent_b), is_same_line(edge, b0))) return false;
    }
    return true;
  }
};

/// Products of four such lengths stay far from both ends of the range of double.
constexpr double kLongestAxis_m = 0x1p100;
bool is_near_one(double length) { return length >= 1 / kLongestAxis_m && length <= kLongestAxis_m; }

/// The gaps between two boxes, four axes at a time.
struct GapsOfAxes {
  double error = 0;
  bool is_in_range = false;
  bool is_sure = true;  // no gap comes within the bound of separating

  HWY_INLINE GapsOfAxes(const BoxPairLanes& pair, const BoxGapBounds& bounds) {
    // A gap changes by at most |n| <= 2 sqrt(3) A^2 times the distance by which the points are moved.
    error = (bounds.of_reach * pair.reach + 4 * bounds.off_m) * pair.axis * pair.axis;
    const double singular = bounds.singular * pair.axis * pair.axis * pair.axis;
    is_in_range =
        is_near_one(pair.axis) && is_near_one(pair.reach) && std::min(pair.a.volume, pair.b.volume) > singular;
  }
  /// False: one of the axes certainly separates.
  HWY_INLINE bool add(AxisLanes gap, AxisMask is_left_out) {
    if (!hn::AllFalse(kAxisDoubles, hn::AndNot(is_left_out, hn::Gt(gap, hn::Set(kAxisDoubles, error))))) return false;
    is_sure = is_sure && hn::AllTrue(kAxisDoubles, hn::Or(is_left_out, hn::Lt(gap, hn::Set(kAxisDoubles, -error))));
    return true;
  }
  HWY_INLINE Decision decision() const { return is_sure ? Decision::yes : Decision::undecided; }
};

/// The depths of two boxes along axes, four at a time, with their bounds.
struct DepthsOfAxes {
  HWY_ALIGN double low[kGroups][kAxes];
  AxisLanes least_high;
  AxisLanes error;

  HWY_INLINE DepthsOfAxes(const BoxPairLanes& pair, double error_share)
      : least_high(hn::Set(kAxisDoubles, std::numeric_limits<double>::infinity())),
        error(hn::Set(kAxisDoubles, error_share * pair.reach * pair.axis * pair.axis)) {}

  /// over_n: the distance of the centres along n, times |n| like the extent.
  HWY_INLINE void add(int group, int lane, const Lanes3& n, AxisLanes extent, AxisLanes over_n) {
    const AxisLanes infinity = hn::Set(kAxisDoubles, std::numeric_limits<double>::infinity());
    const AxisLanes square = dot(n, n);
    // Parallel edges have no reliable normal, and out of range no bound holds: such an axis stays.
    const AxisMask is_plain = hn::And(hn::Gt(square, hn::Set(kAxisDoubles, 1 / kLargestPlain2)),
                                      hn::Lt(square, hn::Set(kAxisDoubles, kLargestPlain2)));
    const AxisLanes one = hn::Set(kAxisDoubles, 1);
    const AxisLanes inverse = hn::Div(one, hn::Sqrt(hn::IfThenElse(is_plain, square, one)));
    const AxisLanes depth = hn::Mul(hn::Sub(extent, over_n), inverse);
    const AxisLanes off = hn::Mul(error, inverse);
    const AxisMask is_known =
        hn::And(is_plain, hn::And(hn::Lt(hn::Abs(depth), infinity), hn::Lt(hn::Abs(off), infinity)));
    hn::Store(hn::IfThenElse(is_known, hn::Sub(depth, off), hn::Neg(infinity)), kAxisDoubles, low[group] + lane);
    least_high = hn::Min(least_high, hn::IfThenElse(is_known, hn::Add(depth, off), infinity));
  }
  HWY_INLINE std::uint32_t may_be_least() const {
    const AxisLanes least = hn::MinOfLanes(kAxisDoubles, least_high);
    std::uint32_t may_be = 0;
    for (int group = 0; group < kGroups; ++group) {
      std::uint32_t bits = 0;
      for (int lane = 0; lane < kAxes; lane += kAxisStride) {
        std::uint8_t few[8] = {};
        hn::StoreMaskBits(kAxisDoubles, hn::Le(hn::Load(kAxisDoubles, low[group] + lane), least), few);
        bits |= static_cast<std::uint32_t>(few[0]) << lane;
      }
      may_be |= (bits & 7u) << (3 * group);
    }
    return may_be;
  }
};

Decision OverlapInLanes(const Box& first, const Box& second, const BoxGapBounds& bounds) {
  const BoxPairLanes pair(first, second);
  GapsOfAxes gaps(pair, bounds);
  if (!gaps.is_in_range) return Decision::undecided;
  const Lanes3 between = spread(pair.between);
  const bool none_separates =
      pair.for_each_group([&](int, int, const Lanes3& n, AxisLanes extent, AxisMask is_left_out) {
        return gaps.add(hn::Sub(over(between, n), extent), is_left_out);
      });
  return none_separates ? gaps.decision() : Decision::no;
}

std::uint32_t LeastPushesInLanes(const Box& first, const Box& second, double error_share) {
  const BoxPairLanes pair(first, second);
  DepthsOfAxes depths(pair, error_share);
  const Lanes3 between = spread(pair.between);
  pair.for_each_group([&](int group, int lane, const Lanes3& n, AxisLanes extent, AxisMask) {
    depths.add(group, lane, n, extent, over(between, n));
    return true;
  });
  return depths.may_be_least();
}

BoxOverlap OverlapAndPushesInLanes(const Box& first, const Box& second, const BoxGapBounds& bounds,
                                   double error_share) {
  const BoxPairLanes pair(first, second);
  GapsOfAxes gaps(pair, bounds);
  if (!gaps.is_in_range) return {};
  DepthsOfAxes depths(pair, error_share);
  const Lanes3 between = spread(pair.between);
  const bool none_separates =
      pair.for_each_group([&](int group, int lane, const Lanes3& n, AxisLanes extent, AxisMask is_left_out) {
        const AxisLanes over_n = over(between, n);
        depths.add(group, lane, n, extent, over_n);
        return gaps.add(hn::Sub(over_n, extent), is_left_out);
      });
  if (!none_separates) return {.decision = Decision::no};
  return {.decision = gaps.decision(), .least_pushes = depths.may_be_least()};
}

/// How far a box reaches along n, times |n|.
HWY_INLINE AxisLanes extent_over(const Lanes3& n, const Box& box) {
  AxisLanes extent = hn::Zero(kAxisDoubles);
  for (int i = 0; i < 3; ++i) {
    const Lanes3 axis = spread({box.axes(0, i), box.axes(1, i), box.axes(2, i)});
    extent = hn::Add(extent, hn::Mul(hn::Set(kAxisDoubles, box.half_m[i]), over(n, axis)));
  }
  return extent;
}

/// If the two separate along an axis throughout, the gap at start and end must exceed the extent of both.
HWY_INLINE AxisMask is_apart(AxisLanes first, AxisLanes last, AxisLanes extent) {
  return hn::Or(hn::Gt(hn::Min(first, last), extent), hn::Lt(hn::Max(first, last), hn::Neg(extent)));
}

bool PartedInLanes(const Box& first, const Box& second, const BoxPairMotion& motion) {
  const BoxPairLanes pair(first, second);
  // Where the centres would have been without rotation, and where they were.
  const double unturned[3] = {pair.between[0] - motion.travel[0], pair.between[1] - motion.travel[1],
                              pair.between[2] - motion.travel[2]};
  const Vec3 start = motion.b_at_start.center - motion.a_at_start.center;
  const double before[3] = {start[0], start[1], start[2]};
  const auto largest = [](const double(&v)[3]) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); };
  const double reach = pair.reach + largest(unturned) + largest(before);
  if (!is_near_one(reach) || !is_near_one(pair.axis)) return false;
  // |n| <= 2 sqrt(3) A^2.
  const double scale = 4 * pair.axis * pair.axis;
  const double error = (motion.error_m + motion.slack * reach) * scale;
  const AxisLanes turned = hn::Set(kAxisDoubles, error + motion.turn_m * scale);
  const AxisLanes bent = hn::Set(kAxisDoubles, error + motion.bend_m * scale);
  const bool turns = motion.turn_m > 0;
  return !pair.for_each_group([&](int, int, const Lanes3& n, AxisLanes extent, AxisMask) {
    const AxisLanes last = dot(spread(pair.between), n);
    if (!hn::AllFalse(kAxisDoubles, is_apart(dot(spread(unturned), n), last, hn::Add(extent, turned)))) return false;
    if (!turns) return true;
    const AxisMask is_apart_last = is_apart(last, last, hn::Add(extent, bent));
    if (hn::AllFalse(kAxisDoubles, is_apart_last)) return true;
    const AxisLanes then = hn::Add(extent_over(n, motion.a_at_start), extent_over(n, motion.b_at_start));
    const AxisLanes most = hn::Add(hn::Max(extent, then), bent);
    return hn::AllFalse(kAxisDoubles, hn::And(is_apart_last, is_apart(dot(spread(before), n), last, most)));
  });
}

}  // namespace
}  // namespace collided::engine::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::kernel {
namespace {

HWY_EXPORT(OverlapInLanes);
HWY_EXPORT(LeastPushesInLanes);
HWY_EXPORT(OverlapAndPushesInLanes);
HWY_EXPORT(PartedInLanes);

}  // namespace

Decision overlap_in_lanes(const Box& a, const Box& b, const BoxGapBounds& bounds) {
  return HWY_DYNAMIC_DISPATCH(OverlapInLanes)(a, b, bounds);
}

std::uint32_t least_pushes_in_lanes(const Box& a, const Box& b, double error_share) {
  return HWY_DYNAMIC_DISPATCH(LeastPushesInLanes)(a, b, error_share);
}

BoxOverlap overlap_and_pushes_in_lanes(const Box& a, const Box& b, const BoxGapBounds& bounds, double error_share) {
  return HWY_DYNAMIC_DISPATCH(OverlapAndPushesInLanes)(a, b, bounds, error_share);
}

bool parted_in_lanes(const Box& a, const Box& b, const BoxPairMotion& motion) {
  return HWY_DYNAMIC_DISPATCH(PartedInLanes)(a, b, motion);
}

}  // namespace collided::engine::kernel
#endif
