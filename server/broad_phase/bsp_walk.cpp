#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/bsp_walk.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "server/broad_phase/bsp_walk-inl.hpp"
#include "server/broad_phase/bsp_walk.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::bsp::HWY_NAMESPACE {
template <bool kCorners, class Call>
HWY_INLINE void walk_prepared(const Layout& layout, const RayFrame& ray, double limit, const Call& call,
                              WalkCost& cost) {
  const Node* nodes = layout.nodes.data();
  const Leaf* leaves = layout.leaves.data();
  const unsigned octant = ray.octant;
  Frame stack[kMaxDepth + 1];
  Frame* top = stack;
  float local_limit = ray.local_limit(limit);
  if (local_limit < 0) return;
  Ref ref = layout.root;
  while (true) {
    ++cost.nodes;
    if (is_leaf(ref)) {
      HWY_ALIGN float estimate[kWidth];
      const Leaf& leaf = leaves[ref & kIndexMask];
      const unsigned present = (2u << (leaf_count(ref) - 1)) - 1;
      const float cap = local_limit < ray.parameter_cap ? local_limit : ray.parameter_cap;
      const unsigned met = met_triangles<kCorners>(leaf, ray, cap, estimate) & present;
      if (met != 0) {
        limit = tell_triangles<kCorners>(call, leaf, met, estimate, limit, cost);
        local_limit = ray.local_limit(limit);
        if (local_limit < 0) return;
      }
    } else {
      const Node& node = nodes[ref];
      const std::uint32_t order = node.order[octant];
      const unsigned mask = met_children(node, ray, local_limit, order, top->entry);
      if (mask != 0) {
        // A frame is written whether or not a second child waits: cheaper than a branch that is hard to foresee.
        ref = node.child[child_at(order, static_cast<unsigned>(__builtin_ctz(mask)))];
        top->node = &node;
        top->order = order;
        top->mask = mask & (mask - 1);
        if (top->mask != 0) {
          fetch(nodes, leaves, node.child[child_at(order, static_cast<unsigned>(__builtin_ctz(top->mask)))]);
          ++top;
        }
        continue;
      }
    }
    float entry;
    do {
      if (top == stack) return;
      Frame& waiting = top[-1];
      const auto place = static_cast<unsigned>(__builtin_ctz(waiting.mask));
      waiting.mask &= waiting.mask - 1;
      top -= waiting.mask == 0 ? 1 : 0;
      entry = waiting.entry[place];
      ref = waiting.node->child[child_at(waiting.order, place)];
    } while (entry > local_limit);
  }
}

template <class Call>
HWY_INLINE void walk_any(const Layout& layout, const Ray& world_ray, double limit, double slack_m, const Call& call,
                         WalkCost& cost) {
  RayFrame ray;
  if (!prepare_ray(layout, world_ray, slack_m, ray)) return;
  if (layout.has_corners) {
    walk_prepared<true>(layout, ray, limit, call, cost);
  } else {
    walk_prepared<false>(layout, ray, limit, call, cost);
  }
}

void WalkRay(const Layout& layout, const Ray& ray, double limit, double slack_m, BspTree::RayCandidate candidate,
             void* context, WalkCost& cost) {
  walk_any(layout, ray, limit, slack_m, NumberCall{candidate, context}, cost);
}

void WalkRayTriangles(const Layout& layout, const Ray& ray, double limit, double slack_m, const TriangleMesh& mesh,
                      BspTree::RayTriangle candidate, void* context, WalkCost& cost) {
  walk_any(layout, ray, limit, slack_m, TriangleCall{candidate, context, mesh, layout.frame}, cost);
}

/// A leaf's triangles as boxes.
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

void WalkBox(const Layout& layout, const LocalBox& asked, BspTree::BoxCandidate candidate, void* context,
             WalkCost& cost) {
  Ref stack[kStackSize];
  int size = 0;
  stack[size++] = layout.root;
  while (size > 0) {
    const Ref ref = stack[--size];
    ++cost.nodes;
    unsigned mask = 0;
    if (is_leaf(ref)) {
      const Leaf& leaf = layout.leaves[ref & kIndexMask];
      for (int first = 0; first < kWidth; first += kLanes) {
        mask |= overlapping(triangle_boxes(leaf, first, layout.has_corners), asked) << first;
      }
      for (mask &= (2u << (leaf_count(ref) - 1)) - 1; mask != 0; mask &= mask - 1) {
        ++cost.candidates;
        if (!candidate(context, leaf.triangle[__builtin_ctz(mask)])) return;
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

/// Squares of distances from the point, rounded down but for the relative 2^-22 that local_limit adds.
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

struct Waiting {
  Ref ref;
  float entry;
};

/// Sorts the children in mask onto the stack, nearest last.
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

void WalkNear(const Layout& layout, const LocalPoint& point, double limit_m2, BspTree::NearCandidate candidate,
              void* context, WalkCost& cost) {
  Waiting stack[kStackSize];
  HWY_ALIGN float distance[kWidth];
  int size = 0;
  float limit = point.local_limit(limit_m2);
  stack[size++] = {layout.root, 0};
  while (size > 0) {
    const Waiting top = stack[--size];
    if (top.entry > limit) continue;
    ++cost.nodes;
    unsigned mask = 0;
    if (is_leaf(top.ref)) {
      const Leaf& leaf = layout.leaves[top.ref & kIndexMask];
      for (int first = 0; first < kWidth; first += kLanes) {
        mask |= within(triangle_boxes(leaf, first, layout.has_corners), point, limit, distance + first) << first;
      }
      mask &= (2u << (leaf_count(top.ref) - 1)) - 1;
      if (mask == 0) continue;
      limit_m2 = tell_triangles<false>(NumberCall{candidate, context}, leaf, mask, distance, limit_m2, cost);
      if (!(limit_m2 >= 0)) return;
      limit = point.local_limit(limit_m2);
      continue;
    }
    const Node& node = layout.nodes[top.ref];
    for (int first = 0; first < kWidth; first += kLanes) {
      mask |= within(child_boxes(node, first), point, limit, distance + first) << first;
    }
    size = push_sorted(node, mask, distance, stack, size);
  }
}

}  // namespace collided::bsp::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::bsp {

HWY_EXPORT(WalkRay);
HWY_EXPORT(WalkRayTriangles);
HWY_EXPORT(WalkBox);
HWY_EXPORT(WalkNear);

float LocalPoint::local_limit(double limit_m2) const {
  if (!(limit_m2 >= 0)) return -1;
  const double local = limit_m2 * limit_scale * limit_scale * (1 + 0x1p-21) + 0x1p-120;
  // Finite, so that the infinitely far missing children stay out.
  return round_up(std::min(local, 0x1p127));
}

void walk_ray(const Layout& layout, const Ray& ray, double limit, double slack_m, BspTree::RayCandidate candidate,
              void* context, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkRay)(layout, ray, limit, slack_m, candidate, context, cost);
}

void walk_ray(const Layout& layout, const Ray& ray, double limit, double slack_m, const TriangleMesh& mesh,
              BspTree::RayTriangle candidate, void* context, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkRayTriangles)(layout, ray, limit, slack_m, mesh, candidate, context, cost);
}

void walk_box(const Layout& layout, const LocalBox& asked, BspTree::BoxCandidate candidate, void* context,
              WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkBox)(layout, asked, candidate, context, cost);
}

void walk_near(const Layout& layout, const LocalPoint& point, double limit_m2, BspTree::NearCandidate candidate,
               void* context, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkNear)(layout, point, limit_m2, candidate, context, cost);
}

}  // namespace collided::bsp
#endif
