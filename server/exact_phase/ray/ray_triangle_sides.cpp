#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/exact_phase/ray/ray_triangle_sides.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "server/exact_phase/ray/ray_triangle_sides.hpp"
#include "server/geometry/tolerance.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::kernel::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Four lanes where the machine has them, else two halves of two, or single doubles.
using Doubles = hn::CappedTag<double, 4>;
using Lanes = hn::Vec<Doubles>;
constexpr Doubles kDoubles;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(kDoubles));

/// One coordinate of the corners, starting with this part's first lane: a, b, c, c.
HWY_INLINE Lanes corner_lanes(double a, double b, double c, int first) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (kLanes == 4) {
    const hn::Half<Doubles> pair;
    return hn::Combine(kDoubles, hn::Set(pair, c), hn::InterleaveLower(pair, hn::Set(pair, a), hn::Set(pair, b)));
  }
#endif
  HWY_ALIGN const double all[4] = {a, b, c, c};
  return hn::Load(kDoubles, all + first);
}

/// The same of the following corners: b, c, a, a.
HWY_INLINE Lanes next_lanes([[maybe_unused]] Lanes corners, double a, double b, double c, int first) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (kLanes == 4) {
    HWY_ALIGN static constexpr std::int64_t kNext[4] = {1, 2, 0, 0};
    return hn::TableLookupLanes(corners, hn::SetTableIndices(kDoubles, kNext));
  }
#endif
  HWY_ALIGN const double all[4] = {b, c, a, a};
  return hn::Load(kDoubles, all + first);
}

struct Triplet {
  Lanes x;
  Lanes y;
  Lanes z;
};
HWY_INLINE Triplet minus(const Triplet& a, const Triplet& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
// kTripleProductError counts on this order of operations, without fused ones.
HWY_INLINE Lanes product(const Triplet& a, const Triplet& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Triplet across(const Triplet& a, const Triplet& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Triplet everywhere(const Vec3& v) {
  return {hn::Set(kDoubles, v[0]), hn::Set(kDoubles, v[1]), hn::Set(kDoubles, v[2])};
}

SidesVerdict RaySidesOf(const Ray& ray, const Triangle& t, RaySides& out) {
  Lanes side[4 / kLanes];
  Lanes edge2 = hn::Zero(kDoubles);
  Lanes corner2 = hn::Zero(kDoubles);
  const Triplet direction = everywhere(ray.direction);
  for (int part = 0; part < 4 / kLanes; ++part) {
    const int first = part * kLanes;
    const Triplet corner{corner_lanes(t.a[0], t.b[0], t.c[0], first), corner_lanes(t.a[1], t.b[1], t.c[1], first),
                         corner_lanes(t.a[2], t.b[2], t.c[2], first)};
    const Triplet next{next_lanes(corner.x, t.a[0], t.b[0], t.c[0], first),
                       next_lanes(corner.y, t.a[1], t.b[1], t.c[1], first),
                       next_lanes(corner.z, t.a[2], t.b[2], t.c[2], first)};
    const Triplet away = minus(corner, everywhere(ray.origin));
    const Triplet edge = minus(next, corner);
    const Lanes squared_edge = product(edge, edge);
    const Lanes squared_away = product(away, away);
    side[part] = product(edge, across(away, direction));
    hn::Store(side[part], kDoubles, out.side + first);
    hn::Store(squared_edge, kDoubles, out.edge2 + first);
    hn::Store(squared_away, kDoubles, out.corner2 + first);
    edge2 = hn::Max(edge2, squared_edge);
    corner2 = hn::Max(corner2, squared_away);
  }
  const Vec3& d = ray.direction;
  const double direction2 = (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
  const double edges2 = hn::GetLane(hn::MaxOfLanes(kDoubles, edge2));
  const double corners2 = hn::GetLane(hn::MaxOfLanes(kDoubles, corner2));
  out.direction2 = direction2;
  // Overflow needs no check: it makes the bound infinite, and nothing exceeds that.
  if (!(std::min({direction2, corners2, edges2}) >= kFilterLowest2)) return SidesVerdict::unsure;
  // Signed squares compare like the numbers, so no root is needed.
  const double bound = kTripleProductError * kTripleProductError * edges2 * corners2 * direction2;
  const auto above = hn::Set(kDoubles, bound);
  const auto below = hn::Set(kDoubles, -bound);
  bool any_above = false;
  bool any_below = false;
  bool all_above = true;
  bool all_below = true;
  for (int part = 0; part < 4 / kLanes; ++part) {
    const Lanes square = hn::Mul(side[part], hn::Abs(side[part]));
    const auto is_above = hn::Gt(square, above);
    const auto is_below = hn::Lt(square, below);
    any_above = any_above || !hn::AllFalse(kDoubles, is_above);
    any_below = any_below || !hn::AllFalse(kDoubles, is_below);
    all_above = all_above && hn::AllTrue(kDoubles, is_above);
    all_below = all_below && hn::AllTrue(kDoubles, is_below);
  }
  if (any_above && any_below) return SidesVerdict::miss;
  return all_above || all_below ? SidesVerdict::inside : SidesVerdict::unsure;
}

}  // namespace collided::engine::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::kernel {

HWY_EXPORT(RaySidesOf);

SidesVerdict ray_sides(const Ray& ray, const Triangle& triangle, RaySides& out) {
  return HWY_DYNAMIC_DISPATCH(RaySidesOf)(ray, triangle, out);
}

}  // namespace collided::engine::kernel
#endif
