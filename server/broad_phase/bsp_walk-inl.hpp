// What the walks of single rays and of batches share, for each instruction set. Included once per target, as Highway's
// own -inl files are.
#if defined(COLLIDED_BSP_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef COLLIDED_BSP_WALK_INL
#undef COLLIDED_BSP_WALK_INL
#else
#define COLLIDED_BSP_WALK_INL
#endif

#include <hwy/highway.h>

#include <limits>

#include "server/broad_phase/bsp_ray.hpp"
#include "server/broad_phase/bsp_tree.hpp"

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

HWY_INLINE bool prepare_ray(const Layout& layout, const Ray& ray, double slack_m, RayFrame& out) {
  return prepare_usual_ray(layout, ray, slack_m, out) || ray_detail::prepare_any_ray(layout, ray, slack_m, out);
}

}  // namespace collided::bsp::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
