#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/exact_phase/distance/box_middle.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cmath>
#include <optional>

#include "server/exact_phase/distance/box_middle.hpp"
#include "server/geometry/tolerance.hpp"

// Without fused operations and in the order of Eigen's sums, so that every instruction set gives the bits of the plain
// form.
HWY_BEFORE_NAMESPACE();
namespace collided::engine::kernel::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kEdges = 4;  // parallel edges of a box
using EdgeDoubles = hn::CappedTag<double, kEdges>;
using EdgeLanes = hn::Vec<EdgeDoubles>;
constexpr EdgeDoubles kEdgeDoubles;
constexpr int kEdgeStride = static_cast<int>(hn::MaxLanes(kEdgeDoubles));

/// On which side of the middle the parallel edges lie, along the two other axes.
HWY_ALIGN constexpr double kFirstSide[kEdges] = {-1, 1, -1, 1};
HWY_ALIGN constexpr double kSecondSide[kEdges] = {-1, -1, 1, 1};

/// A segment in each lane.
struct EdgesOfFour {
  EdgeLanes a[3];
  EdgeLanes b[3];
};

/// The share of each segment, from its a to its b, that lies within some slabs.
struct EdgeShares {
  EdgeLanes low;
  EdgeLanes high;
  hn::Mask<EdgeDoubles> outside;
};

HWY_INLINE EdgeLanes along(const double (&normal)[3], const EdgeLanes (&p)[3]) {
  const EdgeLanes xy =
      hn::Add(hn::Mul(hn::Set(kEdgeDoubles, normal[0]), p[0]), hn::Mul(hn::Set(kEdgeDoubles, normal[1]), p[1]));
  return hn::Add(xy, hn::Mul(hn::Set(kEdgeDoubles, normal[2]), p[2]));
}

HWY_INLINE void clip(EdgeShares& shares, EdgeLanes at_a, EdgeLanes at_b) {
  const EdgeLanes zero = hn::Zero(kEdgeDoubles);
  const EdgeLanes one = hn::Set(kEdgeDoubles, 1);
  const auto a_beyond = hn::Gt(at_a, zero);
  const auto b_beyond = hn::Gt(at_b, zero);
  shares.outside = hn::Or(shares.outside, hn::And(a_beyond, b_beyond));
  const EdgeLanes rest = hn::IfThenElse(hn::Or(a_beyond, b_beyond), hn::Sub(at_a, at_b), one);
  // Where both ends are beyond, the lane is outside whatever comes out.
  const EdgeLanes at = hn::Div(at_a, hn::IfThenElse(hn::Eq(rest, zero), one, rest));
  shares.low = hn::IfThenElse(a_beyond, hn::Max(shares.low, at), shares.low);
  shares.high = hn::IfThenElse(hn::AndNot(a_beyond, b_beyond), hn::Min(shares.high, at), shares.high);
}

HWY_INLINE EdgeShares shares_of(const EdgesOfFour& edges, const BoxSlabs& slabs) {
  EdgeShares shares{hn::Zero(kEdgeDoubles), hn::Set(kEdgeDoubles, 1),
                    hn::Gt(hn::Zero(kEdgeDoubles), hn::Zero(kEdgeDoubles))};
  for (int s = 0; s < 3; ++s) {
    const EdgeLanes a = along(slabs.normal[s], edges.a);
    const EdgeLanes b = along(slabs.normal[s], edges.b);
    const EdgeLanes offset = hn::Set(kEdgeDoubles, slabs.offset[s]);
    const EdgeLanes back_offset = hn::Set(kEdgeDoubles, slabs.back_offset[s]);
    clip(shares, hn::Sub(a, offset), hn::Sub(b, offset));
    clip(shares, hn::Sub(hn::Neg(a), back_offset), hn::Sub(hn::Neg(b), back_offset));
  }
  shares.outside = hn::Or(shares.outside, hn::Gt(shares.low, shares.high));
  return shares;
}

/// The edges along axis k, from lane `first` of four on.
HWY_INLINE EdgesOfFour edges_along(const Core& box, const double (&reach)[3][3], int k, int first) {
  EdgesOfFour edges;
  const EdgeLanes first_side = hn::Load(kEdgeDoubles, kFirstSide + first);
  const EdgeLanes second_side = hn::Load(kEdgeDoubles, kSecondSide + first);
  for (int c = 0; c < 3; ++c) {
    const EdgeLanes shifted = hn::Add(hn::Set(kEdgeDoubles, box.point[0][c]),
                                      hn::Mul(first_side, hn::Set(kEdgeDoubles, reach[(k + 1) % 3][c])));
    const EdgeLanes middle = hn::Add(shifted, hn::Mul(second_side, hn::Set(kEdgeDoubles, reach[(k + 2) % 3][c])));
    const EdgeLanes own = hn::Set(kEdgeDoubles, reach[k][c]);
    edges.a[c] = hn::Sub(middle, own);
    edges.b[c] = hn::Add(middle, own);
  }
  return edges;
}

/// Adds the middles of a box's edges, clipped by the slabs; returns how many there are.
HWY_INLINE int add_middles(const Core& box, const BoxSlabs& slabs, double (&sum)[3]) {
  double reach[3][3];  // axis, coordinate
  for (int k = 0; k < 3; ++k) {
    for (int c = 0; c < 3; ++c) reach[k][c] = box.axes(c, k) * box.half_m[k];
  }
  int count = 0;
  for (int edge = 0; edge < 3 * kEdges; edge += kEdgeStride) {
    const EdgesOfFour edges = edges_along(box, reach, edge / kEdges, edge % kEdges);
    const EdgeShares shares = shares_of(edges, slabs);
    if (hn::AllTrue(kEdgeDoubles, shares.outside)) continue;
    HWY_ALIGN double middle[3][kEdges];
    const EdgeLanes share = hn::Mul(hn::Add(shares.low, shares.high), hn::Set(kEdgeDoubles, 0.5));
    for (int c = 0; c < 3; ++c) {
      hn::Store(hn::Add(edges.a[c], hn::Mul(share, hn::Sub(edges.b[c], edges.a[c]))), kEdgeDoubles, middle[c]);
    }
    std::uint8_t outside[8] = {};
    hn::StoreMaskBits(kEdgeDoubles, shares.outside, outside);
    for (int lane = 0; lane < kEdgeStride; ++lane) {
      if ((outside[0] >> lane & 1) != 0) continue;
      for (int c = 0; c < 3; ++c) sum[c] += middle[c][lane];
      ++count;
    }
  }
  return count;
}

std::optional<Vec3> MiddleOfBoxes(const Core& a, const Core& b, const BoxSlabs& slabs_a, const BoxSlabs& slabs_b) {
  double sum[3] = {0, 0, 0};
  int count = add_middles(a, slabs_b, sum);
  count += add_middles(b, slabs_a, sum);
  const Vec3 all(sum[0], sum[1], sum[2]);
  if (count == 0 || !all.allFinite()) return std::nullopt;
  return all / count;
}

}  // namespace
}  // namespace collided::engine::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::kernel {
namespace {

HWY_EXPORT(MiddleOfBoxes);

bool has_plain_square(double x) {
  constexpr double kFarFromOne = 0x1p200;
  const double size = std::abs(x);
  return (size >= 1 / kFarFromOne && size <= kFarFromOne) || size == 0;
}

/// False: its squares may leave the range of double, or it is zero.
bool make_unit(double (&v)[3]) {
  if (!has_plain_square(v[0]) || !has_plain_square(v[1]) || !has_plain_square(v[2])) return false;
  const double square = (v[0] * v[0] + v[1] * v[1]) + v[2] * v[2];
  if (!(square > 0)) return false;
  const double length = std::sqrt(square);
  for (double& x : v) x /= length;
  return true;
}

/// The slabs that bound a box, grown by the slack of clipping; false as in make_unit().
bool set_slabs(const Core& box, double size_m, BoxSlabs& slabs) {
  const double slack_m = kClipSlack * size_m;
  double axis[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int c = 0; c < 3; ++c) axis[i][c] = box.axes(c, i);
    if (!make_unit(axis[i])) return false;
  }
  for (int i = 0; i < 3; ++i) {
    const double(&u)[3] = axis[(i + 1) % 3];
    const double(&v)[3] = axis[(i + 2) % 3];
    double(&n)[3] = slabs.normal[i];
    for (int c = 0; c < 3; ++c) n[c] = u[(c + 1) % 3] * v[(c + 2) % 3] - u[(c + 2) % 3] * v[(c + 1) % 3];
    if (!make_unit(n)) return false;
    const auto dot_with = [&n](double x, double y, double z) { return (n[0] * x + n[1] * y) + n[2] * z; };
    const double own = dot_with(box.axes(0, i), box.axes(1, i), box.axes(2, i));
    const double reach_m = box.half_m[i] * std::abs(own) + slack_m;
    const double middle = dot_with(box.point[0][0], box.point[0][1], box.point[0][2]);
    slabs.offset[i] = middle + reach_m;
    slabs.back_offset[i] = -middle + reach_m;
  }
  return true;
}

}  // namespace

std::optional<Vec3> middle_of_boxes(const Core& a, const Core& b, double size_m) {
  BoxSlabs slabs_a, slabs_b;
  if (!set_slabs(a, size_m, slabs_a) || !set_slabs(b, size_m, slabs_b)) return std::nullopt;
  return HWY_DYNAMIC_DISPATCH(MiddleOfBoxes)(a, b, slabs_a, slabs_b);
}

}  // namespace collided::engine::kernel
#endif
