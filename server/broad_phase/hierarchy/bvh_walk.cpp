#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/hierarchy/bvh_walk.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "server/broad_phase/hierarchy/bvh_walk-inl.hpp"
#include "server/broad_phase/hierarchy/bvh_walk.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::bvh::HWY_NAMESPACE {
/// Eight boxes of triangles or children, or a part of them that fits the lanes.
struct Boxes {
  Lanes low[3];
  Lanes high[3];
};

HWY_INLINE Boxes triangle_boxes(const Leaf& leaf, int first, bool has_corners) {
  Boxes boxes;
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes a = hn::Load(kFloats, leaf.a[axis] + first);
    const Lanes b = hn::Load(kFloats, leaf.b[axis] + first);
    const Lanes c = hn::Load(kFloats, leaf.c[axis] + first);
    if (has_corners) {
      boxes.low[axis] = hn::Min(a, hn::Min(b, c));
      boxes.high[axis] = hn::Max(a, hn::Max(b, c));
      continue;
    }
    // Corner and edges are rounded by at most 2^-24 + 2 * 2^-24, their sum (below 4) by 2^-23: 5 * 2^-24 in all.
    const Lanes rounding = hn::Set(kFloats, 0x1p-21f);
    const Lanes zero = hn::Zero(kFloats);
    boxes.low[axis] = hn::Sub(hn::Add(a, hn::Min(zero, hn::Min(b, c))), rounding);
    boxes.high[axis] = hn::Add(hn::Add(a, hn::Max(zero, hn::Max(b, c))), rounding);
  }
  return boxes;
}

HWY_INLINE Boxes child_boxes(const Node& node, int first) {
  Boxes boxes;
  for (int axis = 0; axis < 3; ++axis) {
    boxes.low[axis] = hn::Load(kFloats, node.plane[axis][0] + first);
    boxes.high[axis] = hn::Load(kFloats, node.plane[axis][1] + first);
  }
  return boxes;
}

HWY_INLINE unsigned overlapping(const Boxes& boxes, const LocalBox& asked) {
  auto all = hn::Le(boxes.low[0], hn::Set(kFloats, asked.high[0]));
  for (int axis = 0; axis < 3; ++axis) {
    all = hn::And(all, hn::Le(boxes.low[axis], hn::Set(kFloats, asked.high[axis])));
    all = hn::And(all, hn::Ge(boxes.high[axis], hn::Set(kFloats, asked.low[axis])));
  }
  return bits_of(all);
}

/// kBoxes: a leaf is one box, already tested as a child of its node.
template <bool kBoxes>
HWY_INLINE void walk_overlapping(const Layout& layout, const LocalBox& asked, Bvh::BoxCandidate candidate,
                                 WalkCost& cost) {
  Ref stack[kStackSize];
  int size = 0;
  stack[size++] = layout.root;
  while (size > 0) {
    const Ref ref = stack[--size];
    if constexpr (kBoxes) {
      if (is_leaf(ref)) {
        ++cost.candidates;
        if (!candidate(ref & kIndexMask)) return;
        continue;
      }
    }
    ++cost.nodes;
    unsigned mask = 0;
    if (is_leaf(ref)) {
      const Leaf& leaf = layout.leaves[ref & kIndexMask];
      for (int first = 0; first < kWidth; first += kLanes) {
        mask |= overlapping(triangle_boxes(leaf, first, layout.has_corners), asked) << first;
      }
      for (mask &= (2u << (leaf_count(ref) - 1)) - 1; mask != 0; mask &= mask - 1) {
        ++cost.candidates;
        if (!candidate(leaf.triangle[__builtin_ctz(mask)])) return;
      }
      continue;
    }
    const Node& node = layout.nodes[ref];
    for (int first = 0; first < kWidth; first += kLanes) {
      mask |= overlapping(child_boxes(node, first), asked) << first;
    }
    for (; mask != 0; mask &= mask - 1) stack[size++] = node.child[__builtin_ctz(mask)];
  }
}

void WalkBox(const Layout& layout, const LocalBox& asked, Bvh::BoxCandidate candidate, WalkCost& cost) {
  walk_overlapping<false>(layout, asked, candidate, cost);
}

void WalkBoxBoxes(const Layout& layout, const LocalBox& asked, Bvh::BoxCandidate candidate, WalkCost& cost) {
  walk_overlapping<true>(layout, asked, candidate, cost);
}

/// Boxes within the limit of the point. Squared distances are rounded down, except for the relative 2^-22 that
/// local_limit adds.
HWY_INLINE unsigned within(const Boxes& boxes, const LocalPoint& point, float limit, float* distance) {
  Lanes sum = hn::Zero(kFloats);
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes below = hn::Sub(boxes.low[axis], hn::Set(kFloats, point.high[axis]));
    const Lanes above = hn::Sub(hn::Set(kFloats, point.low[axis]), boxes.high[axis]);
    const Lanes away = hn::Max(hn::Max(below, above), hn::Zero(kFloats));
    sum = hn::MulAdd(away, away, sum);
  }
  hn::Store(sum, kFloats, distance);
  return bits_of(hn::Le(sum, hn::Set(kFloats, limit)));
}

/// Boxes that are wholly within the limit, approximately: affects only the cost.
HWY_INLINE unsigned wholly_within(const Boxes& boxes, const LocalPoint& point, float limit) {
  Lanes sum = hn::Zero(kFloats);
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes below = hn::Sub(boxes.high[axis], hn::Set(kFloats, point.low[axis]));
    const Lanes above = hn::Sub(hn::Set(kFloats, point.high[axis]), boxes.low[axis]);
    const Lanes away = hn::Max(below, above);
    sum = hn::MulAdd(away, away, sum);
  }
  return bits_of(hn::Le(sum, hn::Set(kFloats, limit)));
}

struct LaneVector {
  Lanes x;
  Lanes y;
  Lanes z;
};
HWY_INLINE LaneVector minus(const LaneVector& a, const LaneVector& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
/// The point a + s b.
HWY_INLINE LaneVector along(const LaneVector& a, Lanes s, const LaneVector& b) {
  return {hn::MulAdd(s, b.x, a.x), hn::MulAdd(s, b.y, a.y), hn::MulAdd(s, b.z, a.z)};
}
HWY_INLINE Lanes product(const LaneVector& a, const LaneVector& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE LaneVector across(const LaneVector& a, const LaneVector& b) {
  return {hn::NegMulAdd(a.z, b.y, hn::Mul(a.y, b.z)), hn::NegMulAdd(a.x, b.z, hn::Mul(a.z, b.x)),
          hn::NegMulAdd(a.y, b.x, hn::Mul(a.x, b.y))};
}
HWY_INLINE Lanes largest_of(const LaneVector& a) { return hn::Max(hn::Abs(a.x), hn::Max(hn::Abs(a.y), hn::Abs(a.z))); }

/// The point nearest to the origin on the segment from a along the edge.
HWY_INLINE LaneVector foot_on(const LaneVector& a, const LaneVector& edge) {
  const Lanes motion = hn::Div(hn::Neg(product(a, edge)), hn::Add(product(edge, edge), hn::Set(kFloats, 0x1p-100f)));
  return along(a, hn::Min(hn::Max(motion, hn::Zero(kFloats)), hn::Set(kFloats, 1.0f)), edge);
}

/// Triangle corners relative to the queried point, with a bound on each coordinate's error beyond the rounding of the
/// differences.
struct SeenTriangles {
  LaneVector a;
  LaneVector b;
  LaneVector c;
  float error;
};

HWY_INLINE SeenTriangles seen_triangles(const Leaf& leaf, int first, bool has_corners, const LocalPoint& point) {
  Lanes corner[3][3];
  float slack = 0;
  for (int axis = 0; axis < 3; ++axis) {
    slack = std::max(slack, point.high[axis] - point.low[axis]);
    const Lanes center = hn::Set(kFloats, 0.5f * point.low[axis] + 0.5f * point.high[axis]);
    corner[0][axis] = hn::Sub(hn::Load(kFloats, leaf.a[axis] + first), center);
    for (int i = 1; i < 3; ++i) {
      const Lanes stored = hn::Load(kFloats, (i == 1 ? leaf.b : leaf.c)[axis] + first);
      corner[i][axis] = has_corners ? hn::Sub(stored, center) : hn::Add(corner[0][axis], stored);
    }
  }
  const auto triplet = [&](int i) { return LaneVector{corner[i][0], corner[i][1], corner[i][2]}; };
  // Stored corners are off by at most 5 * 2^-24, see triangle_boxes.
  return {triplet(0), triplet(1), triplet(2), slack + 0x1p-21f};
}

/// An approximation of each triangle's point nearest to the origin.
HWY_INLINE LaneVector feet_of(const SeenTriangles& t) {
  const LaneVector ab = minus(t.b, t.a);
  const LaneVector ac = minus(t.c, t.a);
  LaneVector best = foot_on(t.a, ab);
  Lanes best2 = product(best, best);
  const auto try_foot = [&](const LaneVector& foot, auto allowed) {
    const Lanes foot2 = product(foot, foot);
    const auto better = hn::And(allowed, hn::Lt(foot2, best2));
    best = {hn::IfThenElse(better, foot.x, best.x), hn::IfThenElse(better, foot.y, best.y),
            hn::IfThenElse(better, foot.z, best.z)};
    best2 = hn::IfThenElse(better, foot2, best2);
  };
  const auto always = hn::Eq(best2, best2);
  try_foot(foot_on(t.a, ac), always);
  try_foot(foot_on(t.b, minus(t.c, t.b)), always);
  const LaneVector normal = across(ab, ac);
  const Lanes zero = hn::Zero(kFloats);
  auto inside = hn::Ge(product(normal, across(t.a, t.b)), zero);
  inside = hn::And(inside, hn::Ge(product(normal, across(t.b, t.c)), zero));
  inside = hn::And(inside, hn::Ge(product(normal, across(t.c, t.a)), zero));
  const Lanes height = hn::Div(product(normal, t.a), hn::Add(product(normal, normal), hn::Set(kFloats, 0x1p-100f)));
  try_foot({hn::Mul(height, normal.x), hn::Mul(height, normal.y), hn::Mul(height, normal.z)}, inside);
  return best;
}

/// Lower bounds of the squared distances. For any vector v to the foot, the triangle lies behind the plane
/// perpendicular to it at the least of its corners' w . v / |v|. Each coordinate of w is off by `error` and two
/// roundings, the product by three more, all of |w| |v| at most: sqrt(3) error + (2 sqrt(3) + 3) 2^-24 |w| in the
/// quotient, and |w| is at most sqrt(3) times the largest coordinate: below 2 error + 2^-20 of that.
HWY_INLINE Lanes squares_below(const Leaf& leaf, int first, bool has_corners, const LocalPoint& point) {
  const SeenTriangles t = seen_triangles(leaf, first, has_corners, point);
  const LaneVector foot = feet_of(t);
  const Lanes foot2 = product(foot, foot);
  const Lanes least = hn::Min(product(t.a, foot), hn::Min(product(t.b, foot), product(t.c, foot)));
  const Lanes largest = hn::Max(largest_of(t.a), hn::Max(largest_of(t.b), largest_of(t.c)));
  const Lanes error = hn::MulAdd(largest, hn::Set(kFloats, 0x1p-20f), hn::Set(kFloats, 2 * t.error));
  const Lanes behind = hn::Sub(hn::Mul(hn::Div(least, hn::Sqrt(foot2)), hn::Set(kFloats, 1 - 0x1p-19f)), error);
  // A vector of length 0 or NaN gives no plane.
  const auto known = hn::And(hn::Gt(foot2, hn::Set(kFloats, 0x1p-80f)), hn::Gt(behind, hn::Zero(kFloats)));
  return hn::IfThenElseZero(known, hn::Mul(hn::Mul(behind, behind), hn::Set(kFloats, 1 - 0x1p-20f)));
}

/// A child still to visit, with a lower bound on its squared distance.
struct Waiting {
  Ref ref;
  float entry;
};

/// Visits the triangles of a leaf whose bounds in `square` are within the limit, which shrinks meanwhile; returns the
/// new limit.
HWY_INLINE double tell_near(const NumberCall& call, const Leaf& leaf, unsigned mask, const float* square,
                            const LocalPoint& point, double limit_m2, WalkCost& cost) {
  float limit = point.local_limit(limit_m2);
  while (mask != 0) {
    int next = __builtin_ctz(mask);
    for (unsigned rest = mask & (mask - 1); rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      if (square[lane] < square[next]) next = lane;
    }
    if (square[next] > limit) return limit_m2;
    mask &= ~(1u << next);
    ++cost.candidates;
    limit_m2 = call.template tell<false>(leaf, next, limit_m2);
    if (!(limit_m2 >= 0)) return limit_m2;
    limit = point.local_limit(limit_m2);
  }
  return limit_m2;
}

/// Pushes the children in mask onto the stack, sorted, nearest on top.
HWY_INLINE int push_sorted(const Node& node, unsigned mask, const float* entry, Waiting* stack, int size) {
  const int base = size;
  while (mask != 0) {
    const int lane = __builtin_ctz(mask);
    mask &= mask - 1;
    const Waiting added{node.child[lane], entry[lane]};
    int place = size++;
    while (place > base && stack[place - 1].entry < added.entry) {
      stack[place] = stack[place - 1];
      --place;
    }
    stack[place] = added;
  }
  return size;
}

/// Visits the leaves of a walk for near triangles.
class NearLeaves {
 public:
  NearLeaves(const Layout& layout, const LocalPoint& point, Bvh::NearCandidate candidate)
      : layout_(layout), point_(point), candidate_(candidate) {}

  /// Visits the triangles of a leaf that may be near; returns the new limit.
  HWY_INLINE double visit(Ref ref, float limit, double limit_m2, WalkCost& cost) {
    const Leaf& leaf = layout_.leaves[ref & kIndexMask];
    ++cost.nodes;
    HWY_ALIGN float distance[kWidth];
    unsigned mask = 0;
    unsigned inner = 0;
    for (int first = 0; first < kWidth; first += kLanes) {
      const Boxes boxes = triangle_boxes(leaf, first, layout_.has_corners);
      mask |= within(boxes, point_, limit, distance + first) << first;
      inner |= wholly_within(boxes, point_, limit) << first;
    }
    mask &= (2u << (leaf_count(ref) - 1)) - 1;
    if (mask == 0) return limit_m2;
    // A caller that wants everything within reach gains nothing from bounds in a leaf wholly within it; a caller that
    // wants the nearest is recognised by its shrinking limit.
    const bool all_near = lists_all_ && (mask & ~inner) == 0;
    for (int first = 0; first < kWidth && !all_near; first += kLanes) {
      hn::Store(squares_below(leaf, first, layout_.has_corners, point_), kFloats, distance + first);
    }
    const double left_m2 = tell_near(NumberCall{candidate_}, leaf, mask, distance, point_, limit_m2, cost);
    lists_all_ = left_m2 == limit_m2;
    return left_m2;
  }

 private:
  const Layout& layout_;
  const LocalPoint& point_;
  Bvh::NearCandidate candidate_;
  bool lists_all_ = false;
};

/// For leaves of one box, already tested as a child of its node.
struct NearBoxes {
  Bvh::NearCandidate candidate;

  HWY_INLINE double visit(Ref ref, float, double limit_m2, WalkCost& cost) {
    ++cost.candidates;
    return candidate(ref & kIndexMask, limit_m2);
  }
};

template <class Leaves>
HWY_INLINE void walk_nearest_first(const Layout& layout, const LocalPoint& point, double limit_m2, Leaves leaves,
                                   WalkCost& cost) {
  Waiting stack[kStackSize];
  HWY_ALIGN float distance[kWidth];
  int size = 0;
  float limit = point.local_limit(limit_m2);
  stack[size++] = {layout.root, 0};
  while (size > 0) {
    const Waiting top = stack[--size];
    if (top.entry > limit) continue;
    if (is_leaf(top.ref)) {
      const double before_m2 = limit_m2;
      limit_m2 = leaves.visit(top.ref, limit, limit_m2, cost);
      if (!(limit_m2 >= 0)) return;
      if (limit_m2 != before_m2) limit = point.local_limit(limit_m2);
      continue;
    }
    ++cost.nodes;
    const Node& node = layout.nodes[top.ref];
    unsigned mask = 0;
    for (int first = 0; first < kWidth; first += kLanes) {
      mask |= within(child_boxes(node, first), point, limit, distance + first) << first;
    }
    size = push_sorted(node, mask, distance, stack, size);
  }
}

void WalkNear(const Layout& layout, const LocalPoint& point, double limit_m2, Bvh::NearCandidate candidate,
              WalkCost& cost) {
  walk_nearest_first(layout, point, limit_m2, NearLeaves(layout, point, candidate), cost);
}

void WalkNearBoxes(const Layout& layout, const LocalPoint& point, double limit_m2, Bvh::NearCandidate candidate,
                   WalkCost& cost) {
  walk_nearest_first(layout, point, limit_m2, NearBoxes{candidate}, cost);
}

}  // namespace collided::engine::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::bvh {

HWY_EXPORT(WalkBox);
HWY_EXPORT(WalkNear);
HWY_EXPORT(WalkNearBoxes);
HWY_EXPORT(WalkBoxBoxes);

float LocalPoint::local_limit(double limit_m2) const {
  if (!(limit_m2 >= 0)) return -1;
  const double local = limit_m2 * limit_scale * limit_scale * (1 + 0x1p-21) + 0x1p-120;
  // Finite, so that missing children, which are infinitely far, stay out.
  return round_up(std::min(local, 0x1p127));
}

void walk_box(const Layout& layout, const LocalBox& asked, Bvh::BoxCandidate candidate, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkBox)(layout, asked, candidate, cost);
}

void walk_near(const Layout& layout, const LocalPoint& point, double limit_m2, Bvh::NearCandidate candidate,
               WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkNear)(layout, point, limit_m2, candidate, cost);
}

void walk_near_boxes(const Layout& layout, const LocalPoint& point, double limit_m2, Bvh::NearCandidate candidate,
                     WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkNearBoxes)(layout, point, limit_m2, candidate, cost);
}

void walk_box_boxes(const Layout& layout, const LocalBox& asked, Bvh::BoxCandidate candidate, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkBoxBoxes)(layout, asked, candidate, cost);
}

LocalBox local_box(const LocalFrame& frame, const Aabb& asked) {
  // Clamped to just beyond the scene, and finite, so that missing children are never reached.
  constexpr double kBeyond = 4;
  const Vec3 low = frame.to_local(asked.low).cwiseMax(-kBeyond);
  const Vec3 high = frame.to_local(asked.high).cwiseMin(kBeyond);
  LocalBox box;
  for (int axis = 0; axis < 3; ++axis) {
    // Two roundings in double, which the stored vertices did not have.
    box.low[axis] = round_down(low[axis] - 0x1p-50);
    box.high[axis] = round_up(high[axis] + 0x1p-50);
  }
  return box;
}

LocalPoint local_point(const LocalFrame& frame, const Vec3& point, double slack_m) {
  // Farther out, squares of floats overflow; moving a point nearer along an axis only makes the walk more generous.
  constexpr double kFarthest = 0x1p60;
  const Vec3 local = frame.to_local(point);
  LocalPoint ends;
  ends.limit_scale = frame.scale;
  for (int axis = 0; axis < 3; ++axis) {
    const double center = std::clamp(local[axis], -kFarthest, kFarthest);
    const double slack = std::min(slack_m * frame.scale * (1 + kFewSlack), kFarthest);
    const double around = slack + 0x1p-50 * std::abs(center) + 0x1p-60;
    ends.low[axis] = round_down(center - around);
    ends.high[axis] = round_up(center + around);
  }
  return ends;
}

}  // namespace collided::engine::bvh
#endif
