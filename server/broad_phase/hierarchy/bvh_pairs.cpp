#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/hierarchy/bvh_pairs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "server/broad_phase/hierarchy/bvh_pairs.hpp"
#include "server/broad_phase/hierarchy/bvh_walk-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::bvh::HWY_NAMESPACE {

/// Beyond this ratio of sizes only the larger of two nodes is opened: eight boxes against one rule out more than
/// opening both.
constexpr float kMuchLarger = 2;

/// A box along a's axes (0 to 2) and along b's axes (3 to 5).
struct SixBox {
  float low[6];
  float high[6];

  /// The largest side along a's axes.
  float size() const { return std::max(std::max(high[0] - low[0], high[1] - low[1]), high[2] - low[2]); }
};

/// Eight such boxes; a lane whose bit is not in `present` is empty.
struct SixBoxes {
  HWY_ALIGN float low[6][kWidth];
  HWY_ALIGN float high[6][kWidth];
  unsigned present = 0;

  SixBox at(int lane) const {
    SixBox box;
    for (int axis = 0; axis < 6; ++axis) {
      box.low[axis] = low[axis][lane];
      box.high[axis] = high[axis][lane];
    }
    return box;
  }
};

/// A leaf prepared for tests: its triangles' boxes, and their corners and planes along a's axes.
struct Facets {
  SixBoxes boxes;
  HWY_ALIGN float corner[3][3][kWidth];  // corner, axis
  HWY_ALIGN float normal[3][kWidth];     // cross product of two edges
  HWY_ALIGN float edge[kWidth];          // largest component of those edges
  HWY_ALIGN float margin[kWidth];        // for a: how far its corners and b's together may be off
};

/// A small direct-mapped cache of prepared leaves: neighbouring leaves are needed repeatedly, each by several of the
/// other tree.
class FacetCache {
 public:
  static constexpr Ref kPlaces = 8;

  FacetCache() { std::fill(std::begin(held_), std::end(held_), kNothing); }

  Facets& at(Ref leaf) { return facets_[leaf % kPlaces]; }
  /// True if the leaf is in the cache; if not, it takes the entry and the caller must fill it.
  bool holds(Ref leaf) {
    Ref& held = held_[leaf % kPlaces];
    if (held == leaf) return true;
    held = leaf;
    return false;
  }

 private:
  Ref held_[kPlaces];
  Facets facets_[kPlaces];
};

HWY_INLINE unsigned meeting(const SixBoxes& boxes, const float* low, const float* high, std::size_t stride) {
  unsigned mask = 0;
  for (int first = 0; first < kWidth; first += kLanes) {
    auto all = hn::Le(hn::Load(kFloats, boxes.low[0] + first), hn::Set(kFloats, high[0]));
    for (std::size_t axis = 0; axis < 6; ++axis) {
      all = hn::And(all, hn::Le(hn::Load(kFloats, boxes.low[axis] + first), hn::Set(kFloats, high[axis * stride])));
      all = hn::And(all, hn::Ge(hn::Load(kFloats, boxes.high[axis] + first), hn::Set(kFloats, low[axis * stride])));
    }
    mask |= bits_of(all) << first;
  }
  return mask & boxes.present;
}

HWY_INLINE unsigned meeting(const SixBoxes& boxes, const SixBox& one) { return meeting(boxes, one.low, one.high, 1); }

HWY_INLINE unsigned meeting(const SixBoxes& boxes, const SixBoxes& others, int lane) {
  return meeting(boxes, others.low[0] + lane, others.high[0] + lane, kWidth);
}

HWY_INLINE void store(SixBoxes& out, int axis, int first, Lanes low, Lanes high) {
  hn::Store(low, kFloats, out.low[axis] + first);
  hn::Store(high, kFloats, out.high[axis] + first);
}

HWY_INLINE Lanes turned(const float (&row)[3], const Lanes (&v)[3]) {
  return hn::MulAdd(hn::Set(kFloats, row[0]), v[0],
                    hn::MulAdd(hn::Set(kFloats, row[1]), v[1], hn::Mul(hn::Set(kFloats, row[2]), v[2])));
}

HWY_INLINE Lanes turned_size(const float (&row)[3], const Lanes (&v)[3]) {
  const float sizes[3] = {row[0] < 0 ? -row[0] : row[0], row[1] < 0 ? -row[1] : row[1], row[2] < 0 ? -row[2] : row[2]};
  return turned(sizes, v);
}

HWY_INLINE Lanes from_center(Lanes place, const PairFrame& frame, int axis) {
  return hn::Sub(hn::Sub(place, hn::Set(kFloats, frame.center_high[axis])), hn::Set(kFloats, frame.center_low[axis]));
}

/// Ends along a tree's own three axes, with its boxes grown there by `own`, and along the other's by `other`.
HWY_INLINE void six_axes(const Lanes (&low)[3], const Lanes (&high)[3], const float (&to_other)[3][3], int own_axis,
                         int other_axis, float own, float other, int first, SixBoxes& out) {
  const Lanes half_of = hn::Set(kFloats, 0.5f);
  Lanes middle[3], half[3];
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = hn::Mul(hn::Add(low[axis], high[axis]), half_of);
    half[axis] = hn::Mul(hn::Sub(high[axis], low[axis]), half_of);
    store(out, own_axis + axis, first, hn::Sub(low[axis], hn::Set(kFloats, own)),
          hn::Add(high[axis], hn::Set(kFloats, own)));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes center = turned(to_other[axis], middle);
    const Lanes size = hn::Add(turned_size(to_other[axis], half), hn::Set(kFloats, other));
    store(out, other_axis + axis, first, hn::Sub(center, size), hn::Add(center, size));
  }
}

HWY_INLINE Lanes cut_off(Lanes place, float reach) {
  return hn::Min(hn::Max(place, hn::Set(kFloats, -reach)), hn::Set(kFloats, reach));
}

HWY_INLINE void boxes_of_a(const float* const (&low)[3], const float* const (&high)[3], const PairFrame& frame,
                           SixBoxes& out) {
  out.present = 0;
  for (int first = 0; first < kWidth; first += kLanes) {
    Lanes lows[3], highs[3];
    out.present |= bits_of(hn::Le(hn::Load(kFloats, low[0] + first), hn::Load(kFloats, high[0] + first))) << first;
    for (int axis = 0; axis < 3; ++axis) {
      lows[axis] = cut_off(from_center(hn::Load(kFloats, low[axis] + first), frame, axis), frame.reach);
      highs[axis] = cut_off(from_center(hn::Load(kFloats, high[axis] + first), frame, axis), frame.reach);
    }
    six_axes(lows, highs, frame.to_b, 0, 3, frame.box_slack_a, frame.box_slack_b, first, out);
  }
}

HWY_INLINE void boxes_of_b(const float* const (&low)[3], const float* const (&high)[3], const PairFrame& frame,
                           SixBoxes& out) {
  constexpr float kOutside = 2;  // missing children are infinite
  out.present = 0;
  for (int first = 0; first < kWidth; first += kLanes) {
    Lanes lows[3], highs[3];
    out.present |= bits_of(hn::Le(hn::Load(kFloats, low[0] + first), hn::Load(kFloats, high[0] + first))) << first;
    for (int axis = 0; axis < 3; ++axis) {
      lows[axis] = cut_off(hn::Load(kFloats, low[axis] + first), kOutside);
      highs[axis] = cut_off(hn::Load(kFloats, high[axis] + first), kOutside);
    }
    six_axes(lows, highs, frame.to_a, 3, 0, 0, 0, first, out);
  }
}

HWY_INLINE void load_corners(const Leaf& leaf, bool has_corners, int first, Lanes (&out)[3][3]) {
  for (int axis = 0; axis < 3; ++axis) {
    out[0][axis] = hn::Load(kFloats, leaf.a[axis] + first);
    out[1][axis] = hn::Load(kFloats, leaf.b[axis] + first);
    out[2][axis] = hn::Load(kFloats, leaf.c[axis] + first);
    if (has_corners) continue;
    out[1][axis] = hn::Add(out[0][axis], out[1][axis]);
    out[2][axis] = hn::Add(out[0][axis], out[2][axis]);
  }
}

HWY_INLINE Lanes least(Lanes a, Lanes b, Lanes c) { return hn::Min(a, hn::Min(b, c)); }
HWY_INLINE Lanes most(Lanes a, Lanes b, Lanes c) { return hn::Max(a, hn::Max(b, c)); }

HWY_INLINE void store_span(const Lanes (&p)[3][3], int axis, int to, Lanes slack, int first, SixBoxes& out) {
  store(out, to, first, hn::Sub(least(p[0][axis], p[1][axis], p[2][axis]), slack),
        hn::Add(most(p[0][axis], p[1][axis], p[2][axis]), slack));
}

HWY_INLINE void store_planes(const Lanes (&p)[3][3], int first, Facets& out) {
  Lanes e[3], f[3];
  Lanes edge = hn::Zero(kFloats);
  for (int axis = 0; axis < 3; ++axis) {
    for (int corner = 0; corner < 3; ++corner) hn::Store(p[corner][axis], kFloats, out.corner[corner][axis] + first);
    e[axis] = hn::Sub(p[1][axis], p[0][axis]);
    f[axis] = hn::Sub(p[2][axis], p[0][axis]);
    edge = hn::Max(edge, hn::Max(hn::Abs(e[axis]), hn::Abs(f[axis])));
  }
  hn::Store(edge, kFloats, out.edge + first);
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3;
    const int last = (axis + 2) % 3;
    hn::Store(hn::MulSub(e[next], f[last], hn::Mul(e[last], f[next])), kFloats, out.normal[axis] + first);
  }
}

HWY_INLINE void triangles_of_a(const Leaf& leaf, int count, bool has_corners, const PairFrame& frame, Facets& out) {
  out.boxes.present = (2u << (count - 1)) - 1;
  for (int first = 0; first < kWidth; first += kLanes) {
    Lanes p[3][3], along_b[3][3];
    load_corners(leaf, has_corners, first, p);
    Lanes far = hn::Zero(kFloats);
    for (int corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis) {
        p[corner][axis] = from_center(p[corner][axis], frame, axis);
        far = hn::Max(far, hn::Abs(p[corner][axis]));
      }
      for (int axis = 0; axis < 3; ++axis) along_b[corner][axis] = turned(frame.to_b[axis], p[corner]);
    }
    const Lanes slack_a = hn::MulAdd(far, hn::Set(kFloats, frame.grow_a), hn::Set(kFloats, frame.slack_a));
    const Lanes slack_b = hn::MulAdd(far, hn::Set(kFloats, frame.grow_b), hn::Set(kFloats, frame.slack_b));
    hn::Store(slack_a, kFloats, out.margin + first);
    store_planes(p, first, out);
    for (int axis = 0; axis < 3; ++axis) {
      store_span(p, axis, axis, slack_a, first, out.boxes);
      store_span(along_b, axis, 3 + axis, slack_b, first, out.boxes);
    }
  }
}

HWY_INLINE void triangles_of_b(const Leaf& leaf, int count, bool has_corners, const PairFrame& frame, Facets& out) {
  out.boxes.present = (2u << (count - 1)) - 1;
  const Lanes none = hn::Zero(kFloats);
  for (int first = 0; first < kWidth; first += kLanes) {
    Lanes p[3][3], along_a[3][3];
    load_corners(leaf, has_corners, first, p);
    for (int corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis) along_a[corner][axis] = turned(frame.to_a[axis], p[corner]);
    }
    store_planes(along_a, first, out);
    for (int axis = 0; axis < 3; ++axis) {
      store_span(p, axis, 3 + axis, none, first, out.boxes);
      store_span(along_a, axis, axis, none, first, out.boxes);
    }
  }
}

/// Lanes of a leaf from `place` on, or one of its triangles in every lane.
struct SomeFacets {
  const Facets& facets;
  int place;
  bool one;

  HWY_INLINE Lanes get(const float* values) const {
    return one ? hn::Set(kFloats, values[place]) : hn::Load(kFloats, values + place);
  }
};

/// Lanes in which all three corners of the points' triangle are certainly on one side of the planes' triangle.
///
/// Decided by the sign of n . d, with n a cross product of two edges (components at most L) and d the difference from a
/// point of the plane (at most D). In floats a difference, product, difference, product and two sums round each of six
/// products of at most L^2 D, in all below 2^-18 L^2 D. Positions that are off by m together change edges by 2 m and
/// differences by m: with L and D grown by that, by less than 6 (4 m L D + m L^2).
HWY_INLINE unsigned one_sided(const SomeFacets& planes, const SomeFacets& points, Lanes margin) {
  const Facets& plane = planes.facets;
  const Facets& point = points.facets;
  Lanes base[3], normal[3];
  for (int axis = 0; axis < 3; ++axis) {
    base[axis] = planes.get(plane.corner[0][axis]);
    normal[axis] = planes.get(plane.normal[axis]);
  }
  Lanes side[3];
  Lanes motion = hn::Zero(kFloats);
  for (int corner = 0; corner < 3; ++corner) {
    const Lanes dx = hn::Sub(points.get(point.corner[corner][0]), base[0]);
    const Lanes dy = hn::Sub(points.get(point.corner[corner][1]), base[1]);
    const Lanes dz = hn::Sub(points.get(point.corner[corner][2]), base[2]);
    motion = hn::Max(motion, largest_component(dx, dy, dz));
    side[corner] = hn::MulAdd(normal[0], dx, hn::MulAdd(normal[1], dy, hn::Mul(normal[2], dz)));
  }
  // One percent more for the rounding of the bound itself; the last term covers products that underflow.
  const Lanes length = hn::MulAdd(margin, hn::Set(kFloats, 2.0f), planes.get(plane.edge));
  const Lanes distance = hn::Add(margin, motion);
  const Lanes of_margin =
      hn::Mul(margin, hn::MulAdd(hn::Set(kFloats, 24.3f), distance, hn::Mul(hn::Set(kFloats, 6.1f), length)));
  const Lanes of_floats = hn::Mul(hn::Mul(hn::Set(kFloats, 0x1p-18f), length), distance);
  const Lanes error = hn::MulAdd(length, hn::Add(of_margin, of_floats), hn::Set(kFloats, 0x1p-120f));
  const auto above = hn::Gt(least(side[0], side[1], side[2]), error);
  const auto below = hn::Lt(most(side[0], side[1], side[2]), hn::Neg(error));
  return bits_of(hn::Or(above, below));
}

/// Triangles of a, out of mask, that neither plane separates from triangle `lane` of b.
HWY_INLINE unsigned not_parted(const Facets& a, const Facets& b, int lane, unsigned mask) {
  const SomeFacets one{b, lane, true};
  for (int first = 0; first < kWidth; first += kLanes) {
    const SomeFacets many{a, first, false};
    const Lanes margin = hn::Load(kFloats, a.margin + first);
    mask &= ~(one_sided(one, many, margin) << first);
    if (mask == 0) return 0;
    mask &= ~(one_sided(many, one, margin) << first);
  }
  return mask;
}

/// A visit takes some 0.1 us.
constexpr std::uint32_t kVisitsALook = 16;

/// The simultaneous walk over two trees.
class PairWalk {
 public:
  PairWalk(const Layout& a, const Layout& b, const PairFrame& frame, bool swapped, Bvh::PairCandidate candidate,
           Bvh::Interrupt is_over, WalkCost& cost)
      : a_(a), b_(b), frame_(frame), swapped_(swapped), candidate_(candidate), is_over_(is_over), cost_(cost) {}

  void run() {
    SixBoxes boxes_a, boxes_b;
    root(a_, boxes_a, true);
    root(b_, boxes_b, false);
    const SixBox box_a = boxes_a.at(0);
    if ((meeting(boxes_b, box_a) & 1u) == 0) return;
    visit(a_.root, b_.root, box_a, boxes_b.at(0));
  }

 private:
  void root(const Layout& layout, SixBoxes& out, bool of_a) const {
    HWY_ALIGN float ends[6][kWidth];
    for (int axis = 0; axis < 3; ++axis) {
      for (int lane = 0; lane < kWidth; ++lane) {
        ends[axis][lane] = layout.root_low[axis];
        ends[3 + axis][lane] = layout.root_high[axis];
      }
    }
    const float* const low[3] = {ends[0], ends[1], ends[2]};
    const float* const high[3] = {ends[3], ends[4], ends[5]};
    if (of_a) {
      boxes_of_a(low, high, frame_, out);
    } else {
      boxes_of_b(low, high, frame_, out);
    }
  }

  HWY_INLINE void children(const Node& node, SixBoxes& out, bool of_a) const {
    const float* const low[3] = {node.plane[0][0], node.plane[1][0], node.plane[2][0]};
    const float* const high[3] = {node.plane[0][1], node.plane[1][1], node.plane[2][1]};
    if (of_a) {
      boxes_of_a(low, high, frame_, out);
    } else {
      boxes_of_b(low, high, frame_, out);
    }
  }

  /// False: the walk is over. The boxes of a and b must meet.
  bool visit(Ref a, Ref b, const SixBox& box_a, const SixBox& box_b) {
    ++cost_.nodes;
    if (++visits_ % kVisitsALook == 0 && is_over_()) return false;
    if (is_leaf(a) && is_leaf(b)) return leaves(a, b, box_a, box_b);
    if (is_leaf(b)) return open_a(a, b, box_b);
    if (is_leaf(a)) return open_b(a, b, box_a);
    const float size_a = box_a.size();
    const float size_b = box_b.size();
    if (size_a > kMuchLarger * size_b) return open_a(a, b, box_b);
    if (size_b > kMuchLarger * size_a) return open_b(a, b, box_a);
    return open_both(a, b, box_a, box_b);
  }

  bool open_a(Ref a, Ref b, const SixBox& box_b) {
    const Node& node = a_.nodes[a];
    SixBoxes boxes;
    children(node, boxes, true);
    for (unsigned mask = meeting(boxes, box_b); mask != 0; mask &= mask - 1) {
      const int lane = __builtin_ctz(mask);
      if (!visit(node.child[lane], b, boxes.at(lane), box_b)) return false;
    }
    return true;
  }

  bool open_b(Ref a, Ref b, const SixBox& box_a) {
    const Node& node = b_.nodes[b];
    SixBoxes boxes;
    children(node, boxes, false);
    for (unsigned mask = meeting(boxes, box_a); mask != 0; mask &= mask - 1) {
      const int lane = __builtin_ctz(mask);
      if (!visit(a, node.child[lane], box_a, boxes.at(lane))) return false;
    }
    return true;
  }

  bool open_both(Ref a, Ref b, const SixBox& box_a, const SixBox& box_b) {
    const Node& node_a = a_.nodes[a];
    const Node& node_b = b_.nodes[b];
    SixBoxes boxes_a, boxes_b;
    children(node_a, boxes_a, true);
    boxes_a.present = meeting(boxes_a, box_b);
    if (boxes_a.present == 0) return true;
    children(node_b, boxes_b, false);
    for (unsigned rest = meeting(boxes_b, box_a); rest != 0; rest &= rest - 1) {
      const int lane_b = __builtin_ctz(rest);
      unsigned mask = meeting(boxes_a, boxes_b, lane_b);
      if (mask == 0) continue;
      const SixBox one = boxes_b.at(lane_b);
      for (; mask != 0; mask &= mask - 1) {
        const int lane_a = __builtin_ctz(mask);
        if (!visit(node_a.child[lane_a], node_b.child[lane_b], boxes_a.at(lane_a), one)) return false;
      }
    }
    return true;
  }

  bool leaves(Ref a, Ref b, const SixBox& box_a, const SixBox& box_b) {
    const Leaf& leaf_a = a_.leaves[a & kIndexMask];
    const Leaf& leaf_b = b_.leaves[b & kIndexMask];
    Facets& facets_a = cache_a_.at(a);
    Facets& facets_b = cache_b_.at(b);
    if (!cache_a_.holds(a)) triangles_of_a(leaf_a, leaf_count(a), a_.has_corners, frame_, facets_a);
    const unsigned near_b = meeting(facets_a.boxes, box_b);
    if (near_b == 0) return true;
    if (!cache_b_.holds(b)) triangles_of_b(leaf_b, leaf_count(b), b_.has_corners, frame_, facets_b);
    for (unsigned rest = meeting(facets_b.boxes, box_a); rest != 0; rest &= rest - 1) {
      const int lane_b = __builtin_ctz(rest);
      unsigned mask = near_b & meeting(facets_a.boxes, facets_b.boxes, lane_b);
      if (mask != 0) mask = not_parted(facets_a, facets_b, lane_b, mask);
      for (; mask != 0; mask &= mask - 1) {
        ++cost_.candidates;
        const std::uint32_t triangle_a = leaf_a.triangle[__builtin_ctz(mask)];
        const std::uint32_t triangle_b = leaf_b.triangle[lane_b];
        const bool go_on = swapped_ ? candidate_(triangle_b, triangle_a) : candidate_(triangle_a, triangle_b);
        if (!go_on) return false;
      }
    }
    return true;
  }

  const Layout& a_;
  const Layout& b_;
  const PairFrame& frame_;
  bool swapped_;
  Bvh::PairCandidate candidate_;
  Bvh::Interrupt is_over_;
  std::uint32_t visits_ = 0;
  WalkCost& cost_;
  FacetCache cache_a_;
  FacetCache cache_b_;
};

void WalkPairs(const Layout& a, const Layout& b, const PairFrame& frame, bool swapped, Bvh::PairCandidate candidate,
               Bvh::Interrupt is_over, WalkCost& cost) {
  PairWalk(a, b, frame, swapped, candidate, is_over, cost).run();
}

}  // namespace collided::engine::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::bvh {

HWY_EXPORT(WalkPairs);

void walk_pairs(const Layout& a, const Layout& b, const PairFrame& frame, bool swapped, Bvh::PairCandidate candidate,
                Bvh::Interrupt is_over, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkPairs)(a, b, frame, swapped, candidate, is_over, cost);
}

}  // namespace collided::engine::bvh
#endif
