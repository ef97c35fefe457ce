#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/hierarchy/bvh_near_pairs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "server/broad_phase/hierarchy/bvh_near_pairs.hpp"
#include "server/geometry/tolerance.hpp"

// In double, since a distance far larger or smaller than the meshes must still distinguish their triangles. Without
// fused operations, so that every instruction set produces the same pairs in the same order.
HWY_BEFORE_NAMESPACE();
namespace collided::engine::bvh::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, kWidth>;
using Wide = hn::Vec<Doubles>;
constexpr Doubles kDoubles;
constexpr int kStride = static_cast<int>(hn::MaxLanes(kDoubles));

/// Beyond this ratio of sizes only the larger of two nodes is opened.
constexpr double kMuchLarger = 2;
/// Squares are rounded three times a term and twice in their sum; the largest of several is off by no more.
constexpr double kSquareShare = 1 - 0x1p-48;

/// Positions off by some slack on each axis are off along a unit vector by sqrt(3) times as much; the rest covers the
/// rounding of the products with it.
constexpr double kAlongNormal = 3;

/// Eight boxes along a's axes (0 to 2) and along b's (3 to 5); a lane whose bit is not in `present` is empty.
struct TurnedBoxes {
  HWY_ALIGN double low[6][kWidth];
  HWY_ALIGN double high[6][kWidth];
  unsigned present = 0;

  /// The largest side along a's axes.
  double size(int lane) const {
    return std::max(std::max(high[0][lane] - low[0][lane], high[1][lane] - low[1][lane]), high[2][lane] - low[2][lane]);
  }
};

/// The reach of points along a direction, both ways.
struct EndsAlong {
  double low;
  double high;
};

/// A leaf's triangles: corners and normals along a's axes, the latter as long as twice the area. Lanes without a
/// triangle repeat the first.
struct Sheets {
  HWY_ALIGN double corner[3][3][kWidth];  // corner, axis
  HWY_ALIGN double normal[3][kWidth];
  double middle[3];       // of all corners
  double mean_normal[3];  // at most length 1
  EndsAlong along_mean;
  unsigned present = 0;
};

HWY_INLINE Wide widened(const float* values) {
  constexpr hn::Rebind<float, Doubles> kNarrow;
  return hn::PromoteTo(kDoubles, hn::LoadU(kNarrow, values));
}
HWY_INLINE Wide all(double value) { return hn::Set(kDoubles, value); }
HWY_INLINE Wide least(Wide a, Wide b, Wide c) { return hn::Min(a, hn::Min(b, c)); }
HWY_INLINE Wide most(Wide a, Wide b, Wide c) { return hn::Max(a, hn::Max(b, c)); }
HWY_INLINE Wide product(const Wide (&a)[3], const Wide (&b)[3]) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}
HWY_INLINE Wide turned(const double (&row)[3], const Wide (&v)[3]) {
  const Wide rows[3] = {all(row[0]), all(row[1]), all(row[2])};
  return product(rows, v);
}
HWY_INLINE Wide turned_size(const double (&row)[3], const Wide (&v)[3]) {
  const Wide rows[3] = {all(std::abs(row[0])), all(std::abs(row[1])), all(std::abs(row[2]))};
  return product(rows, v);
}

/// Missing children are infinite; converts them to empty boxes with finite ends.
HWY_INLINE Wide finite(Wide place) { return hn::Min(hn::Max(place, all(-2)), all(2)); }

/// The boxes of one tree: its own axes are stored from `own` on, in a's unit; `turn` leads to the other's.
HWY_INLINE void store_boxes(const Wide (&low)[3], const Wide (&high)[3], const double (&turn)[3][3], int own,
                            double unit, int first, TurnedBoxes& out) {
  Wide middle[3], half[3];
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = hn::Mul(hn::Add(low[axis], high[axis]), all(0.5));
    half[axis] = hn::Mul(hn::Sub(high[axis], low[axis]), all(0.5));
    hn::Store(hn::Mul(low[axis], all(unit)), kDoubles, out.low[own + axis] + first);
    hn::Store(hn::Mul(high[axis], all(unit)), kDoubles, out.high[own + axis] + first);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Wide center = turned(turn[axis], middle);
    const Wide size = turned_size(turn[axis], half);
    hn::Store(hn::Sub(center, size), kDoubles, out.low[3 - own + axis] + first);
    hn::Store(hn::Add(center, size), kDoubles, out.high[3 - own + axis] + first);
  }
}

/// Boxes given by their planes, eight floats each.
HWY_INLINE void boxes_of(const float* const (&low)[3], const float* const (&high)[3], bool of_a,
                         const NearPairFrame& frame, TurnedBoxes& out) {
  out.present = 0;
  for (int lane = 0; lane < kWidth; ++lane) {
    // Index apart from the shift: g++ 12 with -fsanitize=undefined uses another lane for the element than for the
    // shift.
    const std::uint32_t is_present = low[0][lane] <= high[0][lane] ? 1 : 0;
    out.present |= is_present << lane;
  }
  for (int first = 0; first < kWidth; first += kStride) {
    Wide lows[3], highs[3];
    for (int axis = 0; axis < 3; ++axis) {
      const Wide from = all(of_a ? frame.origin[axis] : 0);
      lows[axis] = hn::Sub(finite(widened(low[axis] + first)), from);
      highs[axis] = hn::Sub(finite(widened(high[axis] + first)), from);
    }
    if (of_a) store_boxes(lows, highs, frame.to_b, 0, 1, first, out);
    else store_boxes(lows, highs, frame.to_a, 3, frame.unit_b, first, out);
  }
}

/// The reach of all corners along a direction.
HWY_INLINE EndsAlong ends_of(const Sheets& sheets, const double (&direction)[3]) {
  Wide low = all(std::numeric_limits<double>::infinity());
  Wide high = all(-std::numeric_limits<double>::infinity());
  for (int first = 0; first < kWidth; first += kStride) {
    for (int corner = 0; corner < 3; ++corner) {
      Wide p[3];
      for (int axis = 0; axis < 3; ++axis) p[axis] = hn::Load(kDoubles, sheets.corner[corner][axis] + first);
      const Wide along = turned(direction, p);
      low = hn::Min(low, along);
      high = hn::Max(high, along);
    }
  }
  return {hn::GetLane(hn::MinOfLanes(kDoubles, low)), hn::GetLane(hn::MaxOfLanes(kDoubles, high))};
}

double sum_of(const double (&values)[kWidth]) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

/// Makes a vector's length at most 1, and 1 up to rounding unless it is tiny.
void shorten(double (&v)[3]) {
  const double length = std::sqrt(std::max(v[0] * v[0] + v[1] * v[1] + v[2] * v[2], 0x1p-1000));
  for (double& x : v) x /= length;
}

void store_mean(Sheets& out) {
  for (int axis = 0; axis < 3; ++axis) {
    const double sum = sum_of(out.corner[0][axis]) + sum_of(out.corner[1][axis]) + sum_of(out.corner[2][axis]);
    out.middle[axis] = sum / (3 * kWidth);
    out.mean_normal[axis] = sum_of(out.normal[axis]);
  }
  shorten(out.mean_normal);
  out.along_mean = ends_of(out, out.mean_normal);
}

/// Eight floats of a leaf, of which those from `count` on repeat the first.
HWY_INLINE Wide repeated(const float* values, int first, int count) {
  const auto is_there = hn::Lt(hn::Iota(kDoubles, first), all(count));
  return hn::IfThenElse(is_there, widened(values + first), all(values[0]));
}

HWY_INLINE void sheets_of(const Leaf& leaf, int count, bool has_corners, bool of_a, const NearPairFrame& frame,
                          Sheets& out) {
  out.present = (2u << (count - 1)) - 1;
  for (int first = 0; first < kWidth; first += kStride) {
    Wide p[3][3], edge[2][3];
    for (int axis = 0; axis < 3; ++axis) {
      p[0][axis] = hn::Sub(repeated(leaf.a[axis], first, count), all(of_a ? frame.origin[axis] : 0));
      const Wide base = has_corners ? all(of_a ? -frame.origin[axis] : 0) : p[0][axis];
      p[1][axis] = hn::Add(base, repeated(leaf.b[axis], first, count));
      p[2][axis] = hn::Add(base, repeated(leaf.c[axis], first, count));
    }
    for (int corner = 0; corner < 3; ++corner) {
      Wide along_a[3];
      for (int axis = 0; axis < 3; ++axis) along_a[axis] = of_a ? p[corner][axis] : turned(frame.to_a[axis], p[corner]);
      for (int axis = 0; axis < 3; ++axis) {
        p[corner][axis] = along_a[axis];
        hn::Store(along_a[axis], kDoubles, out.corner[corner][axis] + first);
        if (corner > 0) edge[corner - 1][axis] = hn::Sub(along_a[axis], p[0][axis]);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3;
      const int last = (axis + 2) % 3;
      hn::Store(hn::Sub(hn::Mul(edge[0][next], edge[1][last]), hn::Mul(edge[0][last], edge[1][next])), kDoubles,
                out.normal[axis] + first);
    }
  }
  store_mean(out);
}

double gap_between(const EndsAlong& a, const EndsAlong& b) { return std::max(a.low - b.high, b.low - a.high); }

/// Lower bound on the distance of the triangles of two leaves, up to the slack along a direction; not negative unless
/// the leaves are small and near. Tries the mean normal of each, then the line between their middles: together they
/// separate two patches of smooth surfaces whose boxes overlap.
double gap_of_leaves(const Sheets& a, const Sheets& b, double enough) {
  double gap = gap_between(a.along_mean, ends_of(b, a.mean_normal));
  if (gap > enough) return gap;
  gap = std::max(gap, gap_between(b.along_mean, ends_of(a, b.mean_normal)));
  if (gap > enough) return gap;
  double between[3];
  for (int axis = 0; axis < 3; ++axis) between[axis] = b.middle[axis] - a.middle[axis];
  shorten(between);
  return std::max(gap, gap_between(ends_of(a, between), ends_of(b, between)));
}

/// Lower bounds of the squared distances between eight boxes and one of the others.
HWY_INLINE void box_squares(const TurnedBoxes& many, const TurnedBoxes& others, int lane, const NearPairFrame& frame,
                            double* square) {
  for (int first = 0; first < kWidth; first += kStride) {
    Wide sum[2] = {hn::Zero(kDoubles), hn::Zero(kDoubles)};
    for (int axis = 0; axis < 6; ++axis) {
      const Wide after = hn::Sub(hn::Load(kDoubles, many.low[axis] + first), all(others.high[axis][lane]));
      const Wide before = hn::Sub(all(others.low[axis][lane]), hn::Load(kDoubles, many.high[axis] + first));
      const Wide gap = hn::Max(hn::Sub(hn::Max(after, before), all(frame.slack)), hn::Zero(kDoubles));
      sum[axis / 3] = hn::Add(sum[axis / 3], hn::Mul(gap, gap));
    }
    const Wide larger = hn::Max(sum[0], hn::Mul(sum[1], all(frame.turned)));
    hn::Store(hn::Mul(larger, all(kSquareShare)), kDoubles, square + first);
  }
}

/// Sheets from `place` on, or one in every lane.
struct SomeSheets {
  const Sheets& sheets;
  int place;
  bool one;

  HWY_INLINE Wide get(const double* values) const {
    return one ? all(values[place]) : hn::Load(kDoubles, values + place);
  }
};

/// Lower bound on the distance of two triangles along a line of any length, up to the slack.
HWY_INLINE Wide gap_along(const Wide (&line)[3], const Wide (&a)[3][3], const Wide (&b)[3][3]) {
  Wide on_a[3], on_b[3];
  for (int corner = 0; corner < 3; ++corner) {
    on_a[corner] = product(line, a[corner]);
    on_b[corner] = product(line, b[corner]);
  }
  const Wide after = hn::Sub(least(on_b[0], on_b[1], on_b[2]), most(on_a[0], on_a[1], on_a[2]));
  const Wide before = hn::Sub(least(on_a[0], on_a[1], on_a[2]), most(on_b[0], on_b[1], on_b[2]));
  // A nearly vanishing line, as for a triangle without area, gives a weaker bound.
  return hn::Div(hn::Max(after, before), hn::Sqrt(hn::Max(product(line, line), all(0x1p-1000))));
}

/// Lower bounds of the squared distances of eight triangles to one of the others, along the normals of both and along
/// the line between their middles.
HWY_INLINE void sheet_squares(const Sheets& many, const Sheets& others, int lane, double slack, double* square) {
  for (int first = 0; first < kWidth; first += kStride) {
    const SomeSheets some{many, first, false};
    const SomeSheets one{others, lane, true};
    Wide a[3][3], b[3][3], normal_a[3], normal_b[3], between[3];
    for (int axis = 0; axis < 3; ++axis) {
      for (int corner = 0; corner < 3; ++corner) {
        a[corner][axis] = some.get(many.corner[corner][axis]);
        b[corner][axis] = one.get(others.corner[corner][axis]);
      }
      normal_a[axis] = some.get(many.normal[axis]);
      normal_b[axis] = one.get(others.normal[axis]);
      between[axis] = hn::Sub(hn::Add(hn::Add(b[0][axis], b[1][axis]), b[2][axis]),
                              hn::Add(hn::Add(a[0][axis], a[1][axis]), a[2][axis]));
    }
    const Wide gap = most(gap_along(normal_a, a, b), gap_along(normal_b, a, b), gap_along(between, a, b));
    const Wide sure = hn::Max(hn::Sub(gap, all(slack)), hn::Zero(kDoubles));
    hn::Store(hn::Mul(hn::Mul(sure, sure), all(kSquareShare)), kDoubles, square + first);
  }
}

/// Pairs of lanes of two nodes or leaves, nearest first: lower bounds of squared distances, whose last six bits are
/// replaced by the lanes.
class NearestFirst {
 public:
  void add(double square, int lane_a, int lane_b) {
    const std::uint64_t key =
        (std::bit_cast<std::uint64_t>(square) & ~std::uint64_t{63}) | static_cast<unsigned>(lane_a * kWidth + lane_b);
    int place = count_++;
    for (; place > 0 && key_[place - 1] > key; --place) key_[place] = key_[place - 1];
    key_[place] = key;
  }
  int count() const { return count_; }
  double square(int i) const { return std::bit_cast<double>(key_[i] & ~std::uint64_t{63}); }
  int lane_a(int i) const { return static_cast<int>(key_[i] >> 3 & 7); }
  int lane_b(int i) const { return static_cast<int>(key_[i] & 7); }

 private:
  std::uint64_t key_[kWidth * kWidth];
  int count_ = 0;
};

/// Prepared leaves by number: neighbouring leaves are needed again and again.
class SheetCache {
 public:
  SheetCache() { std::fill(std::begin(held_), std::end(held_), kNothing); }

  const Sheets& at(Ref leaf, const Layout& layout, bool of_a, const NearPairFrame& frame) {
    Sheets& sheets = sheets_[leaf % kPlaces];
    Ref& held = held_[leaf % kPlaces];
    if (held != leaf)
      sheets_of(layout.leaves[leaf & kIndexMask], leaf_count(leaf), layout.has_corners, of_a, frame, sheets);
    held = leaf;
    return sheets;
  }

 private:
  static constexpr Ref kPlaces = 64;
  Ref held_[kPlaces];
  Sheets sheets_[kPlaces];
};

/// A node or leaf, and the lane of its box.
struct TreePlace {
  Ref ref;
  const TurnedBoxes* boxes;
  int lane;

  double size() const { return boxes->size(lane); }
};

/// Depth first, the nearer pair of children first.
class NearPairWalk {
 public:
  NearPairWalk(const Layout& a, const Layout& b, const NearPairFrame& frame, double limit_m,
               Bvh::NearPairCandidate candidate, Bvh::Interrupt is_over, WalkCost& cost)
      : a_(a),
        b_(b),
        frame_(frame),
        candidate_(candidate),
        is_over_(is_over),
        cost_(cost),
        limit_m_(limit_m),
        limit2_(frame.local_square(limit_m)) {}

  void run() {
    TurnedBoxes box_a, box_b;
    root(a_, true, box_a);
    root(b_, false, box_b);
    visit({a_.root, &box_a, 0}, {b_.root, &box_b, 0});
  }

 private:
  void root(const Layout& layout, bool of_a, TurnedBoxes& out) const {
    float ends[6][kWidth];
    for (int axis = 0; axis < 3; ++axis) {
      std::fill(ends[axis], ends[axis] + kWidth, layout.root_low[axis]);
      std::fill(ends[3 + axis], ends[3 + axis] + kWidth, layout.root_high[axis]);
    }
    boxes_of({ends[0], ends[1], ends[2]}, {ends[3], ends[4], ends[5]}, of_a, frame_, out);
  }
  void open(const Node& node, bool of_a, TurnedBoxes& out) const {
    boxes_of({node.plane[0][0], node.plane[1][0], node.plane[2][0]},
             {node.plane[0][1], node.plane[1][1], node.plane[2][1]}, of_a, frame_, out);
  }

  /// False: the walk is over.
  bool visit(const TreePlace& a, const TreePlace& b) {
    ++cost_.nodes;
    if (is_over_()) return false;
    if (is_leaf(a.ref) && is_leaf(b.ref)) return leaves(a.ref, b.ref);
    const bool opens_a = !is_leaf(a.ref) && (is_leaf(b.ref) || b.size() <= kMuchLarger * a.size());
    const bool opens_b = !is_leaf(b.ref) && (is_leaf(a.ref) || a.size() <= kMuchLarger * b.size());
    TurnedBoxes boxes_a, boxes_b;
    NearestFirst pairs;
    if (opens_a) open(a_.nodes[a.ref], true, boxes_a);
    if (opens_b) open(b_.nodes[b.ref], false, boxes_b);
    if (!opens_b) {
      list(boxes_a, *b.boxes, b.lane, [&](double square, int lane) { pairs.add(square, lane, b.lane); });
    } else if (!opens_a) {
      list(boxes_b, *a.boxes, a.lane, [&](double square, int lane) { pairs.add(square, a.lane, lane); });
    } else {
      for (unsigned rest = boxes_b.present; rest != 0; rest &= rest - 1) {
        const int lane_b = __builtin_ctz(rest);
        list(boxes_a, boxes_b, lane_b, [&](double square, int lane) { pairs.add(square, lane, lane_b); });
      }
    }
    for (int i = 0; i < pairs.count() && pairs.square(i) <= limit2_; ++i) {
      const int lane_a = pairs.lane_a(i);
      const int lane_b = pairs.lane_b(i);
      const TreePlace next_a = opens_a ? TreePlace{a_.nodes[a.ref].child[lane_a], &boxes_a, lane_a} : a;
      const TreePlace next_b = opens_b ? TreePlace{b_.nodes[b.ref].child[lane_b], &boxes_b, lane_b} : b;
      if (!visit(next_a, next_b)) return false;
    }
    return true;
  }

  /// Calls take(square, lane) for those of eight boxes that may be within the limit of the other.
  template <class Take>
  HWY_INLINE void list(const TurnedBoxes& many, const TurnedBoxes& others, int lane, const Take& take) const {
    HWY_ALIGN double square[kWidth];
    box_squares(many, others, lane, frame_, square);
    for (unsigned rest = many.present; rest != 0; rest &= rest - 1) {
      const int one = __builtin_ctz(rest);
      if (square[one] <= limit2_) take(square[one], one);
    }
  }

  bool leaves(Ref a, Ref b) {
    const Sheets& sheets_a = cache_a_.at(a, a_, true, frame_);
    const Sheets& sheets_b = cache_b_.at(b, b_, false, frame_);
    const double slack = frame_.slack + frame_.edge_slack;
    const double apart = gap_of_leaves(sheets_a, sheets_b, std::sqrt(limit2_) + 2 * kAlongNormal * slack);
    const double sure = std::max(apart - kAlongNormal * slack, 0.0);
    if (sure * sure * kSquareShare > limit2_) return true;
    NearestFirst pairs;
    HWY_ALIGN double square[kWidth];
    for (unsigned rest = sheets_b.present; rest != 0; rest &= rest - 1) {
      const int lane_b = __builtin_ctz(rest);
      sheet_squares(sheets_a, sheets_b, lane_b, kAlongNormal * slack, square);
      for (unsigned some = sheets_a.present; some != 0; some &= some - 1) {
        const int lane_a = __builtin_ctz(some);
        if (square[lane_a] <= limit2_) pairs.add(square[lane_a], lane_a, lane_b);
      }
    }
    for (int i = 0; i < pairs.count() && pairs.square(i) <= limit2_; ++i) {
      ++cost_.candidates;
      limit_m_ = candidate_(a_.leaves[a & kIndexMask].triangle[pairs.lane_a(i)],
                            b_.leaves[b & kIndexMask].triangle[pairs.lane_b(i)], limit_m_);
      if (!(limit_m_ >= 0)) return false;
      limit2_ = frame_.local_square(limit_m_);
    }
    return true;
  }

  const Layout& a_;
  const Layout& b_;
  const NearPairFrame& frame_;
  Bvh::NearPairCandidate candidate_;
  Bvh::Interrupt is_over_;
  WalkCost& cost_;
  double limit_m_;
  double limit2_;
  SheetCache cache_a_;
  SheetCache cache_b_;
};

}  // namespace

void WalkNearPairs(const Layout& a, const Layout& b, const NearPairFrame& frame, double limit_m,
                   Bvh::NearPairCandidate candidate, Bvh::Interrupt is_over, WalkCost& cost) {
  NearPairWalk(a, b, frame, limit_m, candidate, is_over, cost).run();
}

}  // namespace collided::engine::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::bvh {

HWY_EXPORT(WalkNearPairs);

double NearPairFrame::local_square(double limit_m) const {
  const double local = limit_m * scale;
  return local * local * (1 + kFewSlack) + 0x1p-1000;
}

bool prepare_near_pairs(const Layout& a, const Layout& b, const Mat3& rotation, const Vec3& position, double slack_m,
                        NearPairFrame& out) {
  constexpr double kLargest = 0x1p400;
  /// Corners kept as edges are off by 5 * 2^-24 of their tree's local unit on each axis.
  constexpr double kEdgeRounding = 0x1p-21;
  out.scale = a.frame.scale;
  out.unit_b = std::ldexp(1.0, a.frame.scale_exponent - b.frame.scale_exponent);
  const Vec3 origin = (rotation * b.frame.origin + (position - a.frame.origin)) * out.scale;
  const double rows = rotation.cwiseAbs().rowwise().sum().maxCoeff();
  const double columns = rotation.cwiseAbs().colwise().sum().maxCoeff();
  // Every position along a's axes is below this, along b's below this times the columns.
  const double far = origin.lpNorm<1>() + 2 * out.unit_b * rows + 2;
  const double sum_m = rows * b.frame.origin.lpNorm<1>() + position.lpNorm<1>() + a.frame.origin.lpNorm<1>();
  const double skew = (rotation.transpose() * rotation - Mat3::Identity()).cwiseAbs().maxCoeff() + kFewSlack;
  // A position takes at most eight roundings before the walk and twelve in it, each relative to `far`. Along b's axes
  // its own positions are rotated there and back.
  const double off = (slack_m + 0x1p-49 * sum_m) * out.scale + 0x1p-47 * far + 3 * skew * out.unit_b;
  out.slack = std::max(1.0, columns) * off * (1 + kBoundSlack);
  out.edge_slack = ((a.has_corners ? 0 : kEdgeRounding) + (b.has_corners ? 0 : kEdgeRounding * out.unit_b)) *
                   std::max({1.0, rows, columns}) * (1 + kBoundSlack);
  out.turned = 1 / (1 + 3 * skew);
  for (int axis = 0; axis < 3; ++axis) {
    out.origin[axis] = origin[axis];
    for (int k = 0; k < 3; ++k) {
      out.to_a[axis][k] = out.unit_b * rotation(axis, k);
      out.to_b[axis][k] = rotation(k, axis);
    }
  }
  return out.slack <= kLargest && far <= kLargest && out.unit_b >= 1 / kLargest && out.turned > 0;
}

void walk_near_pairs(const Layout& a, const Layout& b, const NearPairFrame& frame, double limit_m,
                     Bvh::NearPairCandidate candidate, Bvh::Interrupt is_over, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkNearPairs)(a, b, frame, limit_m, candidate, is_over, cost);
}

}  // namespace collided::engine::bvh
#endif
