#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/bsp_walk.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "server/broad_phase/bsp_ray.hpp"
#include "server/broad_phase/bsp_walk.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::bsp::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Eight lanes where the machine has them, else two halves of four (or fewer).
using Floats = hn::CappedTag<float, kWidth>;
using Lanes = hn::Vec<Floats>;
constexpr Floats kFloats;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(kFloats));
constexpr int kParts = kWidth / kLanes;

struct Waiting {
  Ref ref;
  float entry;
};

HWY_INLINE unsigned bits_of(hn::Mask<Floats> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kFloats, mask, bytes);
  return bytes[0];
}

HWY_INLINE const float* plane(const Node& node, std::uint32_t byte_offset) {
  return reinterpret_cast<const float*>(reinterpret_cast<const char*>(&node) + byte_offset);
}

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

/// The nearest of the children in mask (not empty); the others wait on the stack.
HWY_INLINE Ref nearest(const Node& node, unsigned mask, const float* entry, Waiting* stack, int& size) {
  const int first = __builtin_ctz(mask);
  mask &= mask - 1;
  if (mask == 0) return node.child[first];
  const int second = __builtin_ctz(mask);
  mask &= mask - 1;
  if (mask == 0) {
    const bool swap = entry[second] < entry[first];
    const int near = swap ? second : first;
    const int far = swap ? first : second;
    stack[size++] = {node.child[far], entry[far]};
    return node.child[near];
  }
  mask |= (1u << first) | (1u << second);
  size = push_sorted(node, mask, entry, stack, size);
  return stack[--size].ref;
}

/// Children that the ray may meet at a parameter in [0, limit].
HWY_INLINE unsigned met_children(const Node& node, const RayFrame& ray, float limit, float* entry) {
  unsigned mask = 0;
  for (int part = 0; part < kParts; ++part) {
    const int first = part * kLanes;
    Lanes near = hn::Zero(kFloats);
    Lanes far = hn::Set(kFloats, limit);
    for (int axis = 0; axis < 3; ++axis) {
      const Lanes inverse = hn::Set(kFloats, ray.inverse[axis]);
      const Lanes to_near = hn::MulSub(hn::Load(kFloats, plane(node, ray.near_plane[axis]) + first), inverse,
                                       hn::Set(kFloats, ray.near_offset[axis]));
      const Lanes to_far = hn::MulSub(hn::Load(kFloats, plane(node, ray.far_plane[axis]) + first), inverse,
                                      hn::Set(kFloats, ray.far_offset[axis]));
      near = hn::Max(near, to_near);
      far = hn::Min(far, to_far);
    }
    hn::Store(near, kFloats, entry + first);
    mask |= bits_of(hn::Le(near, far)) << first;
  }
  return mask;
}

HWY_INLINE Lanes largest_component(Lanes a, Lanes b, Lanes c) {
  return hn::Max(hn::Max(hn::Abs(a), hn::Abs(b)), hn::Abs(c));
}

/// Triangles that the ray may meet at a parameter in [0, limit]; estimate is roughly that parameter.
HWY_INLINE unsigned met_triangles(const Leaf& leaf, const RayFrame& ray, float limit, float* estimate) {
  unsigned mask = 0;
  const Lanes dx = hn::Set(kFloats, ray.direction[0]);
  const Lanes dy = hn::Set(kFloats, ray.direction[1]);
  const Lanes dz = hn::Set(kFloats, ray.direction[2]);
  for (int part = 0; part < kParts; ++part) {
    const int first = part * kLanes;
    const Lanes cx = hn::Sub(hn::Load(kFloats, leaf.corner[0] + first), hn::Set(kFloats, ray.origin[0]));
    const Lanes cy = hn::Sub(hn::Load(kFloats, leaf.corner[1] + first), hn::Set(kFloats, ray.origin[1]));
    const Lanes cz = hn::Sub(hn::Load(kFloats, leaf.corner[2] + first), hn::Set(kFloats, ray.origin[2]));
    const Lanes ax = hn::Load(kFloats, leaf.edge1[0] + first);
    const Lanes ay = hn::Load(kFloats, leaf.edge1[1] + first);
    const Lanes az = hn::Load(kFloats, leaf.edge1[2] + first);
    const Lanes bx = hn::Load(kFloats, leaf.edge2[0] + first);
    const Lanes by = hn::Load(kFloats, leaf.edge2[1] + first);
    const Lanes bz = hn::Load(kFloats, leaf.edge2[2] + first);

    const Lanes rx = hn::MulSub(cy, dz, hn::Mul(cz, dy));
    const Lanes ry = hn::MulSub(cz, dx, hn::Mul(cx, dz));
    const Lanes rz = hn::MulSub(cx, dy, hn::Mul(cy, dx));
    const Lanes nx = hn::MulSub(ay, bz, hn::Mul(az, by));
    const Lanes ny = hn::MulSub(az, bx, hn::Mul(ax, bz));
    const Lanes nz = hn::MulSub(ax, by, hn::Mul(ay, bx));
    const Lanes u = hn::MulAdd(rx, bx, hn::MulAdd(ry, by, hn::Mul(rz, bz)));
    const Lanes v = hn::Neg(hn::MulAdd(rx, ax, hn::MulAdd(ry, ay, hn::Mul(rz, az))));
    const Lanes det = hn::MulAdd(nx, dx, hn::MulAdd(ny, dy, hn::Mul(nz, dz)));
    const Lanes t = hn::MulAdd(nx, cx, hn::MulAdd(ny, cy, hn::Mul(nz, cz)));
    const Lanes w = hn::Sub(hn::Sub(det, u), v);

    const Lanes edge = hn::Max(largest_component(ax, ay, az), largest_component(bx, by, bz));
    const Lanes sign_slack = hn::MulAdd(hn::Set(kFloats, ray.sign_slope), edge, hn::Set(kFloats, ray.sign_floor));
    const Lanes entry_slack =
        hn::MulAdd(hn::MulAdd(hn::Set(kFloats, ray.entry_slope), edge, hn::Set(kFloats, ray.entry_linear)), edge,
                   hn::Set(kFloats, ray.entry_floor));

    const auto none_negative = hn::Ge(hn::Min(u, hn::Min(v, w)), hn::Neg(sign_slack));
    const auto none_positive = hn::Le(hn::Max(u, hn::Max(v, w)), sign_slack);
    const Lanes sign = hn::And(det, hn::SignBit(kFloats));
    const Lanes along = hn::Xor(t, sign);
    const Lanes det_size = hn::Abs(det);
    const auto after_start = hn::Ge(along, hn::Neg(entry_slack));
    const auto before_limit = hn::Le(along, hn::MulAdd(hn::Set(kFloats, limit), det_size, entry_slack));
    const auto met = hn::And(hn::Or(none_negative, none_positive), hn::And(after_start, before_limit));
    const unsigned bits = bits_of(met);
    if (bits != 0) hn::Store(hn::Div(along, det_size), kFloats, estimate + first);
    mask |= bits << first;
  }
  return mask;
}

/// Calls the candidates of a leaf, nearest first; the new limit.
HWY_INLINE double call_triangles(const Leaf& leaf, unsigned mask, const float* estimate, double limit,
                                 BspTree::RayCandidate candidate, void* context, WalkCost& cost) {
  while (mask != 0) {
    int next = __builtin_ctz(mask);
    for (unsigned rest = mask & (mask - 1); rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      if (estimate[lane] < estimate[next]) next = lane;
    }
    mask &= ~(1u << next);
    ++cost.candidates;
    limit = candidate(context, leaf.triangle[next], limit);
    if (!(limit >= 0)) return limit;
  }
  return limit;
}

void WalkRay(const Layout& layout, const Ray& world_ray, double limit, double slack_m,
             BspTree::RayCandidate candidate, void* context, WalkCost& cost) {
  RayFrame ray;
  if (!prepare_ray(layout, world_ray, slack_m, ray)) return;
  const Node* nodes = layout.nodes.data();
  const Leaf* leaves = layout.leaves.data();
  Waiting stack[kStackSize];
  HWY_ALIGN float entry[kWidth];
  float local_limit = ray.local_limit(limit);
  std::uint32_t visited = 0;
  int size = 0;
  Ref ref = layout.root;
  while (true) {
    unsigned mask = 1;
    while (!is_leaf(ref)) {
      ++visited;
      const Node& node = nodes[ref];
      mask = met_children(node, ray, local_limit, entry);
      if (mask == 0) break;
      ref = nearest(node, mask, entry, stack, size);
    }
    if (mask != 0) {
      ++visited;
      const Leaf& leaf = leaves[ref & kIndexMask];
      const unsigned present = (2u << (leaf_count(ref) - 1)) - 1;
      mask = met_triangles(leaf, ray, std::min(local_limit, ray.parameter_cap), entry) & present;
      if (mask != 0) {
        limit = call_triangles(leaf, mask, entry, limit, candidate, context, cost);
        local_limit = ray.local_limit(limit);
        if (local_limit < 0) break;
      }
    }
    do {
      if (size == 0) {
        cost.nodes += visited;
        return;
      }
      --size;
    } while (stack[size].entry > local_limit);
    ref = stack[size].ref;
  }
  cost.nodes += visited;
}

/// A leaf's triangles as boxes.
struct Boxes {
  Lanes low[3];
  Lanes high[3];
};

HWY_INLINE Boxes triangle_boxes(const Leaf& leaf, int first) {
  Boxes boxes;
  const Lanes zero = hn::Zero(kFloats);
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes corner = hn::Load(kFloats, leaf.corner[axis] + first);
    const Lanes edge1 = hn::Load(kFloats, leaf.edge1[axis] + first);
    const Lanes edge2 = hn::Load(kFloats, leaf.edge2[axis] + first);
    // Corner and edges are rounded by at most 2^-24 + 2 * 2^-24, their sum (below 4) by 2^-23: 5 * 2^-24 in all.
    const Lanes rounding = hn::Set(kFloats, 0x1p-21f);
    boxes.low[axis] = hn::Sub(hn::Add(corner, hn::Min(zero, hn::Min(edge1, edge2))), rounding);
    boxes.high[axis] = hn::Add(hn::Add(corner, hn::Max(zero, hn::Max(edge1, edge2))), rounding);
  }
  return boxes;
}

HWY_INLINE Boxes child_boxes(const Node& node, int first) {
  Boxes boxes;
  for (int axis = 0; axis < 3; ++axis) {
    boxes.low[axis] = hn::Load(kFloats, node.low[axis] + first);
    boxes.high[axis] = hn::Load(kFloats, node.high[axis] + first);
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
        mask |= overlapping(triangle_boxes(leaf, first), asked) << first;
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
        mask |= within(triangle_boxes(leaf, first), point, limit, distance + first) << first;
      }
      mask &= (2u << (leaf_count(top.ref) - 1)) - 1;
      if (mask == 0) continue;
      limit_m2 = call_triangles(leaf, mask, distance, limit_m2, candidate, context, cost);
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
HWY_EXPORT(WalkBox);
HWY_EXPORT(WalkNear);

float LocalPoint::local_limit(double limit_m2) const {
  if (!(limit_m2 >= 0)) return -1;
  return round_up(limit_m2 * limit_scale * limit_scale * (1 + 0x1p-21) + 0x1p-120);
}

void walk_ray(const Layout& layout, const Ray& ray, double limit, double slack_m, BspTree::RayCandidate candidate,
              void* context, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkRay)(layout, ray, limit, slack_m, candidate, context, cost);
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
