#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/bsp_walk.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

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

/// Three axes and a spare lane.
using Axes = hn::CappedTag<double, 4>;
using AxesFloat = hn::Rebind<float, Axes>;

/// prepare_any_ray for the usual ray, with every error as the worst of its kind; false: not usual.
HWY_INLINE bool prepare_usual_ray(const Layout& layout, const Ray& ray, double slack_m, RayFrame& out) {
  using namespace ray_detail;
  constexpr Axes axes;
  constexpr AxesFloat floats;
  if constexpr (hn::MaxLanes(axes) < 4) return false;
  static_assert(offsetof(Ray, direction) == 3 * sizeof(double) && offsetof(Ray, length_m) == 6 * sizeof(double));
  static_assert(offsetof(LocalFrame, origin) == 0 && offsetof(LocalFrame, scale) == 3 * sizeof(double));
  const LocalFrame& frame = layout.frame;
  const auto three = hn::FirstN(axes, 3);
  // Each load takes the member behind along in the spare lane.
  const auto start = hn::LoadU(axes, &ray.origin[0]);
  const auto local = hn::IfThenElseZero(
      three, hn::Mul(hn::Sub(start, hn::LoadU(axes, &frame.origin[0])), hn::Set(axes, frame.scale)));
  const auto direction = hn::IfThenElseZero(three, hn::LoadU(axes, &ray.direction[0]));
  const int exponent = exponent_of(hn::GetLane(hn::MaxOfLanes(axes, hn::Abs(direction))));
  const double slack = slack_m * frame.scale * (1 + 0x1p-50);
  const bool near = hn::AllTrue(axes, hn::Le(hn::Abs(local), hn::Set(axes, kNear)));
  if (!near || !is_usual(exponent, frame.scale_exponent) || !(slack < 1)) return false;

  const auto origin = hn::DemoteTo(floats, local);
  const auto rounded = hn::DemoteTo(floats, hn::Mul(direction, hn::Set(axes, power_of_two(-exponent))));
  const auto clamped = hn::CopySign(
      hn::Max(hn::Abs(rounded), hn::Set(floats, static_cast<float>(kLeastDirection))), rounded);
  const auto inverse = hn::Div(hn::Set(floats, 1.0f), clamped);
  // Roundings in u: of the start 1 |o|; the inverse 2 (|o| + 1); the offset's sum and product 2 |o|; in the walk the
  // product 1, the difference 1 + |o|. A hundredth more for their products with each other.
  const auto wide = hn::MulAdd(hn::Abs(origin), hn::Set(floats, static_cast<float>(6.1 * kUnit)),
                               hn::Set(floats, static_cast<float>(4.1 * kUnit + 2 * kLeastSlack + 1.01 * slack)));
  const auto shift = hn::CopySign(wide, inverse);
  hn::Store(origin, floats, out.origin);
  hn::Store(clamped, floats, out.direction);
  hn::Store(inverse, floats, out.inverse);
  hn::Store(hn::Mul(hn::Add(origin, shift), inverse), floats, out.near_offset);
  hn::Store(hn::Mul(hn::Sub(origin, shift), inverse), floats, out.far_offset);
  set_planes(out);
  const double reach = hn::GetLane(hn::MaxOfLanes(axes, hn::Abs(local)));
  set_leaf_slack(kUnit * reach + 2 * kLeastSlack, slack, out);
  out.is_moved = false;
  out.to_local_1 = power_of_two(exponent + frame.scale_exponent);
  return true;
}

HWY_INLINE unsigned bits_of(hn::Mask<Floats> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kFloats, mask, bytes);
  return bytes[0];
}

HWY_INLINE const float* plane(const Node& node, std::uint32_t byte_offset) {
  return reinterpret_cast<const float*>(reinterpret_cast<const char*>(&node) + byte_offset);
}

/// The child at place i of an order.
HWY_INLINE unsigned child_at(std::uint32_t order, unsigned i) { return order >> (3 * i) & 7u; }

/// Children that the ray may meet at a parameter in [0, limit], as places in the order; entry likewise.
HWY_INLINE unsigned met_children(const Node& node, const RayFrame& ray, float limit, std::uint32_t order,
                                 float* entry) {
  unsigned mask = 0;
  HWY_ALIGN float unordered[kWidth];
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
    if constexpr (kLanes == kWidth) {
      using Numbers = hn::RebindToUnsigned<Floats>;
      constexpr Numbers numbers;
      const auto shift = hn::Mul(hn::Iota(numbers, 0), hn::Set(numbers, 3));
      const auto place = hn::And(hn::Shr(hn::Set(numbers, order), shift), hn::Set(numbers, 7));
      const auto places = hn::IndicesFromVec(kFloats, place);
      near = hn::TableLookupLanes(near, places);
      far = hn::TableLookupLanes(far, places);
      hn::Store(near, kFloats, entry);
      return bits_of(hn::Le(near, far));
    }
    hn::Store(near, kFloats, unordered + first);
    mask |= bits_of(hn::Le(near, far)) << first;
  }
  unsigned ordered = 0;
  for (unsigned i = 0; i < kWidth; ++i) {
    const unsigned child = child_at(order, i);
    entry[i] = unordered[child];
    ordered |= (mask >> child & 1u) << i;
  }
  return ordered;
}

HWY_INLINE Lanes largest_component(Lanes a, Lanes b, Lanes c) {
  return hn::Max(hn::Max(hn::Abs(a), hn::Abs(b)), hn::Abs(c));
}

/// Triangles that the ray may meet at a parameter in [0, limit]; estimate is roughly that parameter.
template <bool kCorners>
HWY_INLINE unsigned met_triangles(const Leaf& leaf, const RayFrame& ray, float limit, float* estimate) {
  unsigned mask = 0;
  const Lanes dx = hn::Set(kFloats, ray.direction[0]);
  const Lanes dy = hn::Set(kFloats, ray.direction[1]);
  const Lanes dz = hn::Set(kFloats, ray.direction[2]);
  for (int part = 0; part < kParts; ++part) {
    const int first = part * kLanes;
    const Lanes px = hn::Load(kFloats, leaf.a[0] + first);
    const Lanes py = hn::Load(kFloats, leaf.a[1] + first);
    const Lanes pz = hn::Load(kFloats, leaf.a[2] + first);
    Lanes ax = hn::Load(kFloats, leaf.b[0] + first);
    Lanes ay = hn::Load(kFloats, leaf.b[1] + first);
    Lanes az = hn::Load(kFloats, leaf.b[2] + first);
    Lanes bx = hn::Load(kFloats, leaf.c[0] + first);
    Lanes by = hn::Load(kFloats, leaf.c[1] + first);
    Lanes bz = hn::Load(kFloats, leaf.c[2] + first);
    if constexpr (kCorners) {
      ax = hn::Sub(ax, px);
      ay = hn::Sub(ay, py);
      az = hn::Sub(az, pz);
      bx = hn::Sub(bx, px);
      by = hn::Sub(by, py);
      bz = hn::Sub(bz, pz);
    }
    const Lanes cx = hn::Sub(px, hn::Set(kFloats, ray.origin[0]));
    const Lanes cy = hn::Sub(py, hn::Set(kFloats, ray.origin[1]));
    const Lanes cz = hn::Sub(pz, hn::Set(kFloats, ray.origin[2]));

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
    // An edge-on triangle has no parameter of its own: never 0/0, which a host may trap.
    const Lanes divisor = hn::Max(det_size, hn::Set(kFloats, std::numeric_limits<float>::min()));
    if (bits != 0) hn::Store(hn::Div(along, divisor), kFloats, estimate + first);
    mask |= bits << first;
  }
  return mask;
}

/// Who hears of a ray's candidates: by number, or by number and corners.
struct NumberCall {
  BspTree::RayCandidate candidate;
  void* context;

  template <bool kCorners>
  HWY_INLINE double tell(const Leaf& leaf, int lane, double limit) const {
    return candidate(context, leaf.triangle[lane], limit);
  }
};

struct TriangleCall {
  BspTree::RayTriangle candidate;
  void* context;
  const TriangleMesh& mesh;
  const LocalFrame& frame;

  template <bool kCorners>
  HWY_INLINE double tell(const Leaf& leaf, int lane, double limit) const {
    const std::uint32_t number = leaf.triangle[lane];
    if constexpr (!kCorners) return candidate(context, number, mesh.triangle(number), limit);
    Triangle triangle;
    for (int axis = 0; axis < 3; ++axis) {
      triangle.a[axis] = frame.to_world(leaf.a[axis][lane], axis);
      triangle.b[axis] = frame.to_world(leaf.b[axis][lane], axis);
      triangle.c[axis] = frame.to_world(leaf.c[axis][lane], axis);
    }
    return candidate(context, number, triangle, limit);
  }
};

/// Tells the candidates of a leaf, nearest first; the new limit.
template <bool kCorners, class Call>
HWY_INLINE double tell_triangles(const Call& call, const Leaf& leaf, unsigned mask, const float* estimate,
                                 double limit, WalkCost& cost) {
  while (mask != 0) {
    int next = __builtin_ctz(mask);
    for (unsigned rest = mask & (mask - 1); rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      if (estimate[lane] < estimate[next]) next = lane;
    }
    mask &= ~(1u << next);
    ++cost.candidates;
    limit = call.template tell<kCorners>(leaf, next, limit);
    if (!(limit >= 0)) break;
  }
  return limit;
}

/// Children of a node that still wait, as places in the order, the nearest in the lowest bit.
struct alignas(64) Frame {
  float entry[kWidth];
  const Node* node;
  std::uint32_t order;
  std::uint32_t mask;
};

HWY_INLINE void fetch(const Node* nodes, const Leaf* leaves, Ref ref) {
  const char* p = is_leaf(ref) ? reinterpret_cast<const char*>(leaves + (ref & kIndexMask))
                               : reinterpret_cast<const char*>(nodes + ref);
  __builtin_prefetch(p);
  __builtin_prefetch(p + 64);
  __builtin_prefetch(p + 128);
  __builtin_prefetch(p + 192);
}

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
  if (!prepare_usual_ray(layout, world_ray, slack_m, ray) &&
      !ray_detail::prepare_any_ray(layout, world_ray, slack_m, ray)) {
    return;
  }
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
