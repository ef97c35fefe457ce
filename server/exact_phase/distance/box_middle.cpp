#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/exact_phase/distance/box_middle.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cmath>
#include <optional>

#include "server/exact_phase/distance/box_middle.hpp"
#include "server/geometry/tolerance.hpp"

// Without fused operations and in the order of Eigen's sums, so that every instruction set gives the same bits as the
// plain form.
HWY_BEFORE_NAMESPACE();
namespace collided::engine::kernel::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kEdges = 4;  // parallel edges of a box
using EdgeDoubles = hn::CappedTag<double, kEdges>;
using EdgeLanes = hn::Vec<EdgeDoubles>;
constexpr EdgeDoubles kEdgeDoubles;
constexpr int kEdgeStride = static_cast<int>(hn::MaxLanes(kEdgeDoubles));

/// The sides of the middle on which the parallel edges lie, along the two other axes.
HWY_ALIGN constexpr double kFirstSide[kEdges] = {-1, 1, -1, 1};
HWY_ALIGN constexpr double kSecondSide[kEdges] = {-1, -1, 1, 1};

/// {x : -back_offset <= normal . x <= offset} for three normals; the first once more in the last lane.
struct BoxSlabs {
  double normal[3][kEdges];  // coordinate, slab
  double offset[kEdges];
  double back_offset[kEdges];
};

HWY_INLINE EdgeLanes dot(const EdgeLanes (&a)[3], const EdgeLanes (&b)[3]) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}

/// Divides the vector in each lane by its length. False if its squares may leave the range of double, or it is zero.
HWY_INLINE bool make_units(EdgeLanes (&v)[3]) {
  constexpr double kFarFromOne = 0x1p200;
  const EdgeLanes zero = hn::Zero(kEdgeDoubles);
  const EdgeLanes square = dot(v, v);
  auto is_plain = hn::Gt(square, zero);
  for (const EdgeLanes& x : v) {
    const EdgeLanes size = hn::Abs(x);
    const auto is_near_one =
        hn::And(hn::Ge(size, hn::Set(kEdgeDoubles, 1 / kFarFromOne)), hn::Le(size, hn::Set(kEdgeDoubles, kFarFromOne)));
    is_plain = hn::And(is_plain, hn::Or(is_near_one, hn::Eq(size, zero)));
  }
  if (!hn::AllTrue(kEdgeDoubles, is_plain)) return false;
  const EdgeLanes length = hn::Sqrt(square);
  for (EdgeLanes& x : v) x = hn::Div(x, length);
  return true;
}

/// The slabs that bound a box, grown by the slack of clipping; false as in make_units().
HWY_INLINE bool set_slabs(const Core& box, double size_m, BoxSlabs& slabs) {
  double axis[3][kEdges];      // coordinate, axis with repetition
  double unit[3][kEdges + 2];  // same
  double half_m[kEdges];
  for (int i = 0; i < kEdges; ++i) {
    for (int c = 0; c < 3; ++c) axis[c][i] = box.axes(c, i % 3);
    half_m[i] = box.half_m[i % 3];
  }
  for (int first = 0; first < kEdges; first += kEdgeStride) {
    EdgeLanes own[3];
    for (int c = 0; c < 3; ++c) own[c] = hn::LoadU(kEdgeDoubles, axis[c] + first);
    if (!make_units(own)) return false;
    for (int c = 0; c < 3; ++c) hn::StoreU(own[c], kEdgeDoubles, unit[c] + first);
  }
  for (int c = 0; c < 3; ++c) {
    for (int i = kEdges; i < kEdges + 2; ++i) unit[c][i] = unit[c][i - 3];
  }
  const EdgeLanes slack_m = hn::Set(kEdgeDoubles, kClipSlack * size_m);
  EdgeLanes center[3];
  for (int c = 0; c < 3; ++c) center[c] = hn::Set(kEdgeDoubles, box.point[0][c]);
  for (int first = 0; first < kEdges; first += kEdgeStride) {
    EdgeLanes own[3], u[3], v[3], n[3];
    for (int c = 0; c < 3; ++c) {
      own[c] = hn::LoadU(kEdgeDoubles, axis[c] + first);
      u[c] = hn::LoadU(kEdgeDoubles, unit[c] + first + 1);
      v[c] = hn::LoadU(kEdgeDoubles, unit[c] + first + 2);
    }
    for (int c = 0; c < 3; ++c) {
      const int c1 = (c + 1) % 3;
      const int c2 = (c + 2) % 3;
      n[c] = hn::Sub(hn::Mul(u[c1], v[c2]), hn::Mul(u[c2], v[c1]));
    }
    if (!make_units(n)) return false;
    const EdgeLanes half = hn::LoadU(kEdgeDoubles, half_m + first);
    const EdgeLanes reach_m = hn::Add(hn::Mul(half, hn::Abs(dot(n, own))), slack_m);
    const EdgeLanes middle = dot(n, center);
    for (int c = 0; c < 3; ++c) hn::StoreU(n[c], kEdgeDoubles, slabs.normal[c] + first);
    hn::StoreU(hn::Add(middle, reach_m), kEdgeDoubles, slabs.offset + first);
    hn::StoreU(hn::Add(hn::Neg(middle), reach_m), kEdgeDoubles, slabs.back_offset + first);
  }
  return true;
}

/// A segment in each lane.
struct EdgesOfFour {
  EdgeLanes a[3];
  EdgeLanes b[3];
};

/// The part of each segment, as fractions from a to b, inside some slabs.
struct EdgeShares {
  EdgeLanes low;
  EdgeLanes high;
  hn::Mask<EdgeDoubles> outside;
};

HWY_INLINE void clip(EdgeShares& shares, EdgeLanes at_a, EdgeLanes at_b) {
  const EdgeLanes zero = hn::Zero(kEdgeDoubles);
  const EdgeLanes one = hn::Set(kEdgeDoubles, 1);
  const auto a_beyond = hn::Gt(at_a, zero);
  const auto b_beyond = hn::Gt(at_b, zero);
  shares.outside = hn::Or(shares.outside, hn::And(a_beyond, b_beyond));
  // If both ends are beyond, the lane is outside regardless of the result.
  const EdgeLanes at = hn::Div(at_a, hn::IfThenElse(hn::Xor(a_beyond, b_beyond), hn::Sub(at_a, at_b), one));
  shares.low = hn::IfThenElse(a_beyond, hn::Max(shares.low, at), shares.low);
  shares.high = hn::IfThenElse(hn::AndNot(a_beyond, b_beyond), hn::Min(shares.high, at), shares.high);
}

HWY_INLINE EdgeShares shares_of(const EdgesOfFour& edges, const BoxSlabs& slabs) {
  EdgeShares shares{hn::Zero(kEdgeDoubles), hn::Set(kEdgeDoubles, 1),
                    hn::Gt(hn::Zero(kEdgeDoubles), hn::Zero(kEdgeDoubles))};
  for (int s = 0; s < 3; ++s) {
    const EdgeLanes normal[3] = {hn::Set(kEdgeDoubles, slabs.normal[0][s]), hn::Set(kEdgeDoubles, slabs.normal[1][s]),
                                 hn::Set(kEdgeDoubles, slabs.normal[2][s])};
    const EdgeLanes a = dot(normal, edges.a);
    const EdgeLanes b = dot(normal, edges.b);
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

std::optional<Vec3> MiddleOfBoxes(const Core& a, const Core& b, double size_m) {
  BoxSlabs slabs_a, slabs_b;
  if (!set_slabs(a, size_m, slabs_a) || !set_slabs(b, size_m, slabs_b)) return std::nullopt;
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

}  // namespace

std::optional<Vec3> middle_of_boxes(const Core& a, const Core& b, double size_m) {
  return HWY_DYNAMIC_DISPATCH(MiddleOfBoxes)(a, b, size_m);
}

}  // namespace collided::engine::kernel
#endif
