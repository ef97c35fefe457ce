// Shared by the walks of single rays and of batches, for each instruction set. Included once per target, like Highway's
// own -inl files.
#if defined(COLLIDED_BVH_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef COLLIDED_BVH_WALK_INL
#undef COLLIDED_BVH_WALK_INL
#else
#define COLLIDED_BVH_WALK_INL
#endif

#include <hwy/highway.h>

#include <limits>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_ray-inl.hpp"
#include "server/geometry/tolerance.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::bvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Eight lanes if the machine has them, else two halves of four (or fewer).
using Floats = hn::CappedTag<float, kWidth>;
using Lanes = hn::Vec<Floats>;
constexpr Floats kFloats;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(kFloats));
constexpr int kParts = kWidth / kLanes;

HWY_INLINE unsigned bits_of(hn::Mask<Floats> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kFloats, mask, bytes);
  return bytes[0];
}

HWY_INLINE const float* plane(const Node& node, std::uint32_t byte_offset) {
  return reinterpret_cast<const float*>(reinterpret_cast<const char*>(&node) + byte_offset);
}

/// A ray's slabs in every lane, so that a walk loads only nodes.
struct Slabs {
  const RayFrame& ray;
  Lanes inverse[3];
  Lanes near_offset[3];
  Lanes far_offset[3];

  explicit HWY_INLINE Slabs(const RayFrame& of) : ray(of) {
    for (int axis = 0; axis < 3; ++axis) {
      inverse[axis] = hn::Set(kFloats, ray.inverse[axis]);
      near_offset[axis] = hn::Set(kFloats, ray.near_offset[axis]);
      far_offset[axis] = hn::Set(kFloats, ray.far_offset[axis]);
    }
  }
};

/// Children of a node in the order of the walk. waiting: the unvisited ones that the ray may meet, one bit each, lowest
/// first.
struct alignas(32) WalkFrame {
  float entry[kWidth];
  Ref child[kWidth];
  unsigned waiting;
};
HWY_INLINE unsigned place_of(unsigned waiting) { return static_cast<unsigned>(__builtin_ctz(waiting)); }

/// A node's order as numbers: lane k holds the k-th child of the walk. For eight lanes.
using Numbers = hn::RebindToUnsigned<Floats>;
HWY_INLINE hn::Vec<Numbers> places_in(std::uint32_t order) {
  constexpr Numbers numbers;
  const auto shift = hn::Mul(hn::Iota(numbers, 0), hn::Set(numbers, 3));
  return hn::And(hn::Shr(hn::Set(numbers, order), shift), hn::Set(numbers, 7));
}

/// The order in which a walk takes a node's children: near to far, or, if any triangle is enough, those first that most
/// rays stop at.
enum class Way { near_first, most_occluding_first };

/// Writes a node's children into the frame and returns those that the ray may meet at a parameter in [0, limit], in the
/// form of WalkFrame::waiting.
template <Way kWay>
HWY_INLINE unsigned met_children(const Node& node, const Slabs& slabs, float limit, WalkFrame& frame) {
  const RayFrame& ray = slabs.ray;
  const std::uint32_t order = kWay == Way::near_first ? node.order[ray.octant] : node.occlusion_order();
  HWY_ALIGN float unordered[kWidth];
  unsigned mask = 0;
  for (int part = 0; part < kParts; ++part) {
    const int first = part * kLanes;
    Lanes near[3];
    Lanes far[3];
    for (int axis = 0; axis < 3; ++axis) {
      near[axis] = hn::MulSub(hn::Load(kFloats, plane(node, ray.near_plane[axis]) + first), slabs.inverse[axis],
                              slabs.near_offset[axis]);
      far[axis] = hn::MulSub(hn::Load(kFloats, plane(node, ray.far_plane[axis]) + first), slabs.inverse[axis],
                             slabs.far_offset[axis]);
    }
    Lanes enter = hn::Max(hn::Max(near[0], near[1]), hn::Max(near[2], hn::Zero(kFloats)));
    Lanes leave = hn::Min(hn::Min(far[0], far[1]), hn::Min(far[2], hn::Set(kFloats, limit)));
    if constexpr (kLanes == kWidth) {
      constexpr Numbers numbers;
      const auto place = places_in(order);
      const auto children = hn::TableLookupLanes(hn::Load(numbers, node.child), hn::IndicesFromVec(numbers, place));
      hn::Store(children, numbers, frame.child);
      const auto places = hn::IndicesFromVec(kFloats, place);
      enter = hn::TableLookupLanes(enter, places);
      leave = hn::TableLookupLanes(leave, places);
      hn::Store(enter, kFloats, frame.entry);
      return bits_of(hn::Le(enter, leave));
    }
    hn::Store(enter, kFloats, unordered + first);
    mask |= bits_of(hn::Le(enter, leave)) << first;
  }
  unsigned ordered = 0;
  for (unsigned i = 0; i < kWidth; ++i) {
    const unsigned child = order >> (3 * i) & 7u;
    frame.entry[i] = unordered[child];
    frame.child[i] = node.child[child];
    ordered |= (mask >> child & 1u) << i;
  }
  return ordered;
}

HWY_INLINE Lanes largest_component(Lanes a, Lanes b, Lanes c) {
  return hn::Max(hn::Max(hn::Abs(a), hn::Abs(b)), hn::Abs(c));
}

/// Tests a ray against the triangles of a leaf. least_, most_: of the signs U, V, W; along_ / size_: the parameter.
template <bool kCorners>
class TriangleTest {
 public:
  HWY_INLINE TriangleTest(const Leaf& leaf, const RayFrame& ray) {
    for (int part = 0; part < kParts; ++part) fill(leaf, ray, part);
  }

  /// Triangles that the ray may meet at a parameter in [0, limit].
  HWY_INLINE unsigned met(float limit) const {
    unsigned mask = 0;
    for (int part = 0; part < kParts; ++part) {
      const Lanes slack = sign_slack_[part];
      const Lanes before = entry_slack_[part];
      const auto inside = hn::Or(hn::Ge(least_[part], hn::Neg(slack)), hn::Le(most_[part], slack));
      const auto after_start = hn::Ge(along_[part], hn::Neg(before));
      const auto before_limit = hn::Le(along_[part], hn::MulAdd(hn::Set(kFloats, limit), size_[part], before));
      mask |= bits_of(hn::And(inside, hn::And(after_start, before_limit))) << (part * kLanes);
    }
    return mask;
  }
  /// Triangles that the ray's line certainly meets at a parameter of at least 0: the signs agree beyond every rounding.
  HWY_INLINE unsigned sure() const {
    unsigned mask = 0;
    for (int part = 0; part < kParts; ++part) mask |= bits_of(is_sure(part)) << (part * kLanes);
    return mask;
  }
  /// Those of them certainly met at a parameter of at most the limit.
  HWY_INLINE unsigned sure_within(float limit) const {
    unsigned mask = 0;
    for (int part = 0; part < kParts; ++part) {
      const Lanes end = hn::MulSub(hn::Set(kFloats, limit), size_[part], entry_slack_[part]);
      mask |= bits_of(hn::And(is_sure(part), hn::Le(along_[part], end))) << (part * kLanes);
    }
    return mask;
  }
  /// Approximate parameters, for sorting only.
  HWY_INLINE void estimate(float* parameter) const {
    for (int part = 0; part < kParts; ++part) {
      hn::Store(hn::Div(along_[part], divisor(part)), kFloats, parameter + part * kLanes);
    }
  }
  /// Lower bounds of the parameters, and upper ones for triangles that are certainly met: the slack covers the error of
  /// along_ and size_ together, 2^-21 the three roundings of the quotient.
  HWY_INLINE void bounds(float* low, float* high) const {
    for (int part = 0; part < kParts; ++part) {
      const Lanes inverse = hn::Div(hn::Set(kFloats, 1.0f), divisor(part));
      const Lanes rounding = hn::Set(kFloats, 0x1p-21f);
      const Lanes first = hn::Mul(hn::Sub(along_[part], entry_slack_[part]), inverse);
      const Lanes last = hn::Mul(hn::Add(along_[part], entry_slack_[part]), inverse);
      hn::Store(hn::NegMulAdd(hn::Abs(first), rounding, first), kFloats, low + part * kLanes);
      hn::Store(hn::MulAdd(hn::Abs(last), rounding, last), kFloats, high + part * kLanes);
    }
  }

 private:
  HWY_INLINE hn::Mask<Floats> is_sure(int part) const {
    const Lanes slack = sign_slack_[part];
    const auto inside = hn::Or(hn::Gt(least_[part], slack), hn::Lt(most_[part], hn::Neg(slack)));
    return hn::And(inside, hn::Ge(along_[part], entry_slack_[part]));
  }
  /// An edge-on triangle has no parameter: avoid 0/0, which a host may trap.
  HWY_INLINE Lanes divisor(int part) const {
    return hn::Max(size_[part], hn::Set(kFloats, std::numeric_limits<float>::min()));
  }

  HWY_INLINE void fill(const Leaf& leaf, const RayFrame& ray, int part) {
    const int first = part * kLanes;
    const Lanes dx = hn::Set(kFloats, ray.direction[0]);
    const Lanes dy = hn::Set(kFloats, ray.direction[1]);
    const Lanes dz = hn::Set(kFloats, ray.direction[2]);
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
    sign_slack_[part] = hn::MulAdd(hn::Set(kFloats, ray.sign_slope), edge, hn::Set(kFloats, ray.sign_floor));
    entry_slack_[part] =
        hn::MulAdd(hn::MulAdd(hn::Set(kFloats, ray.entry_slope), edge, hn::Set(kFloats, ray.entry_linear)), edge,
                   hn::Set(kFloats, ray.entry_floor));

    least_[part] = hn::Min(u, hn::Min(v, w));
    most_[part] = hn::Max(u, hn::Max(v, w));
    along_[part] = hn::Xor(t, hn::And(det, hn::SignBit(kFloats)));
    size_[part] = hn::Abs(det);
  }

  Lanes least_[kParts];
  Lanes most_[kParts];
  Lanes along_[kParts];
  Lanes size_[kParts];
  Lanes sign_slack_[kParts];
  Lanes entry_slack_[kParts];
};

/// The receiver of a ray's candidates: by number here, by number and corners below.
struct NumberCall {
  Bvh::RayCandidate candidate;

  template <bool kCorners>
  HWY_INLINE double tell(const Leaf& leaf, int lane, double limit) const {
    return candidate(leaf.triangle[lane], limit);
  }
};

/// The corners exactly as in the mesh: leaves hold corners only if the conversion to floats loses nothing.
HWY_INLINE Triangle corners_of(const Leaf& leaf, int lane, const LocalFrame& frame) {
  Triangle triangle;
  for (int axis = 0; axis < 3; ++axis) {
    triangle.a[axis] = frame.to_world(leaf.a[axis][lane], axis);
    triangle.b[axis] = frame.to_world(leaf.b[axis][lane], axis);
    triangle.c[axis] = frame.to_world(leaf.c[axis][lane], axis);
  }
  return triangle;
}

struct TriangleCall {
  Bvh::RayTriangle candidate;
  const TriangleMesh& mesh;
  const LocalFrame& frame;

  template <bool kCorners>
  HWY_INLINE Triangle corners(const Leaf& leaf, int lane) const {
    if constexpr (!kCorners) return mesh.triangle(leaf.triangle[lane]);
    return corners_of(leaf, lane, frame);
  }
  template <bool kCorners>
  HWY_INLINE double tell(const Leaf& leaf, int lane, double limit) const {
    return candidate(leaf.triangle[lane], corners<kCorners>(leaf, lane), limit);
  }
};

/// How far a walk still searches: the caller's limit, and the local one, which certain hits shorten further.
struct WalkReach {
  double limit;
  float local;

  HWY_INLINE bool is_over() const { return !(limit >= 0) || local < 0; }
  HWY_INLINE void shorten(const RayFrame& ray, double new_limit) {
    limit = new_limit;
    const float new_local = ray.local_limit(new_limit);
    local = new_local < local ? new_local : local;
  }
};

/// Visits one candidate; false: the walk is over.
template <bool kCorners, class Call>
HWY_INLINE bool tell(const Call& call, const RayFrame& ray, const Leaf& leaf, int lane, WalkReach& reach,
                     WalkCost& cost) {
  ++cost.candidates;
  reach.shorten(ray, call.template tell<kCorners>(leaf, lane, reach.limit));
  return !reach.is_over();
}

/// Visits the candidates of a leaf, nearest first.
template <bool kCorners, class Call>
HWY_INLINE bool tell_every(const Call& call, const RayFrame& ray, const Leaf& leaf, unsigned met, const float* estimate,
                           WalkReach& reach, WalkCost& cost) {
  while (met != 0) {
    int next = __builtin_ctz(met);
    for (unsigned rest = met & (met - 1); rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      if (estimate[lane] < estimate[next]) next = lane;
    }
    met &= ~(1u << next);
    if (!tell<kCorners>(call, ray, leaf, next, reach, cost)) return false;
  }
  return true;
}

/// Certain hits, if the nearest is wanted: they shorten the reach when found, and at the end only those are visited
/// that no nearer one rules out, usually one.
class SureHits {
 public:
  bool empty() const { return count_ == 0; }
  const Leaf& leaf(int i) const { return *leaf_[i]; }
  int count() const { return count_; }
  int lane(int i) const { return lane_[i]; }
  void clear() { count_ = 0; }

  /// Takes a leaf's hits, and visits those that are not certain. False: the walk is over.
  template <bool kCorners, class Call>
  HWY_INLINE bool visit(const Call& call, const RayFrame& ray, const Leaf& leaf, const TriangleTest<kCorners>& test,
                        unsigned met, WalkReach& reach, WalkCost& cost) {
    HWY_ALIGN float low[kWidth];
    HWY_ALIGN float high[kWidth];
    test.bounds(low, high);
    const unsigned sure = test.sure() & met;
    float nearest = reach.local;
    for (unsigned rest = sure; rest != 0; rest &= rest - 1) {
      const float end = high[__builtin_ctz(rest)];
      nearest = end < nearest ? end : nearest;
    }
    if (nearest < reach.local) drop_beyond(nearest);
    reach.local = nearest;
    for (unsigned rest = met & ~sure; rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      if (low[lane] <= reach.local && !tell<kCorners>(call, ray, leaf, lane, reach, cost)) return false;
    }
    for (unsigned rest = sure; rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      if (low[lane] > reach.local) continue;
      if (count_ == kMost && !settle<kCorners>(call, ray, reach, cost)) return false;
      low_[count_] = low[lane];
      leaf_[count_] = &leaf;
      lane_[count_++] = static_cast<std::uint8_t>(lane);
    }
    return true;
  }

  /// Visits those that may still be the nearest, in order of their lower bounds. False: the walk is over.
  template <bool kCorners, class Call>
  HWY_INLINE bool settle(const Call& call, const RayFrame& ray, WalkReach& reach, WalkCost& cost) {
    while (count_ > 0) {
      int next = 0;
      for (int i = 1; i < count_; ++i) next = low_[i] < low_[next] ? i : next;
      if (low_[next] > reach.local) break;
      const Leaf& of = *leaf_[next];
      const int lane = lane_[next];
      --count_;
      low_[next] = low_[count_];
      leaf_[next] = leaf_[count_];
      lane_[next] = lane_[count_];
      if (!tell<kCorners>(call, ray, of, lane, reach, cost)) return false;
    }
    count_ = 0;
    return true;
  }

 private:
  static constexpr int kMost = 8;

  HWY_INLINE void drop_beyond(float limit) {
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
      if (low_[i] > limit) continue;
      low_[kept] = low_[i];
      leaf_[kept] = leaf_[i];
      lane_[kept++] = lane_[i];
    }
    count_ = kept;
  }

  int count_ = 0;
  float low_[kMost];
  const Leaf* leaf_[kMost];
  std::uint8_t lane_[kMost];
};

/// The first triangle of a leaf, by its lane, that the ray meets; visits candidates only if floats are uncertain. By
/// lane, so that every instruction set finds the same one.
template <bool kCorners, class Call>
HWY_INLINE std::uint32_t first_met(const Call& call, const RayFrame& ray, const Leaf& leaf, unsigned met, unsigned sure,
                                   WalkReach& reach, WalkCost& cost, Triangle& corners) {
  for (; met != 0; met &= met - 1) {
    const int lane = __builtin_ctz(met);
    if ((sure >> lane & 1u) == 0 && tell<kCorners>(call, ray, leaf, lane, reach, cost)) continue;
    corners = call.template corners<kCorners>(leaf, lane);
    return leaf.triangle[lane];
  }
  return Bvh::kNoTriangle;
}

/// Goes to the next waiting child that is not beyond the limit; false if there is none.
HWY_INLINE bool climb(const WalkFrame* stack, float limit, WalkFrame*& top, Ref& ref) {
  float entry;
  do {
    if (top == stack) return false;
    WalkFrame& frame = top[-1];
    const unsigned place = place_of(frame.waiting);
    frame.waiting &= frame.waiting - 1;
    top -= frame.waiting == 0 ? 1 : 0;
    entry = frame.entry[place];
    ref = frame.child[place];
  } while (entry > limit);
  return true;
}

HWY_INLINE void fetch(const Node* nodes, const Leaf* leaves, Ref ref) {
  const auto first_leaf = reinterpret_cast<std::uintptr_t>(leaves);
  const auto first_node = reinterpret_cast<std::uintptr_t>(nodes);
  const std::uintptr_t leaf = first_leaf + sizeof(Leaf) * (ref & kIndexMask);
  const std::uintptr_t node = first_node + sizeof(Node) * ref;
  const auto* p = reinterpret_cast<const char*>(is_leaf(ref) ? leaf : node);
  __builtin_prefetch(p);
  __builtin_prefetch(p + 64);
  __builtin_prefetch(p + 128);
  __builtin_prefetch(p + 192);
}

}  // namespace collided::engine::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
