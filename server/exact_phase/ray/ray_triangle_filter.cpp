#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/exact_phase/ray/ray_triangle_filter.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "server/exact_phase/arithmetic/triple.hpp"
#include "server/exact_phase/arithmetic/value.hpp"
#include "server/exact_phase/ray/ray_triangle_filter.hpp"
#include "server/exact_phase/ray/ray_triangle_kernel.hpp"
#include "server/geometry/tolerance.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::kernel::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Four lanes if the machine has them, else two halves of two, or single doubles.
using Doubles = hn::CappedTag<double, 4>;
using Lanes = hn::Vec<Doubles>;
constexpr Doubles kDoubles;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(kDoubles));

/// Four numbers, starting with this part's first lane.
HWY_INLINE Lanes lanes_of(double a, double b, double c, double d, [[maybe_unused]] int first) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (kLanes == 4) {
    const hn::Half<Doubles> pair;
    const auto high = hn::InterleaveLower(pair, hn::Set(pair, c), hn::Set(pair, d));
    return hn::Combine(kDoubles, high, hn::InterleaveLower(pair, hn::Set(pair, a), hn::Set(pair, b)));
  }
#endif
  HWY_ALIGN const double all[4] = {a, b, c, d};
  return hn::Load(kDoubles, all + first);
}

/// One coordinate of the corners: a, b, c, c.
HWY_INLINE Lanes corner_lanes(double a, double b, double c, [[maybe_unused]] int first) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (kLanes == 4) {
    const hn::Half<Doubles> pair;
    return hn::Combine(kDoubles, hn::Set(pair, c), hn::InterleaveLower(pair, hn::Set(pair, a), hn::Set(pair, b)));
  }
#endif
  return lanes_of(a, b, c, c, first);
}

/// The following corners: b, c, a, a.
HWY_INLINE Lanes next_lanes([[maybe_unused]] Lanes corners, double a, double b, double c, [[maybe_unused]] int first) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (kLanes == 4) {
    HWY_ALIGN static constexpr std::int64_t kNext[4] = {1, 2, 0, 0};
    return hn::TableLookupLanes(corners, hn::SetTableIndices(kDoubles, kNext));
  }
#endif
  return lanes_of(b, c, a, a, first);
}

struct Triplet {
  Lanes x;
  Lanes y;
  Lanes z;
};
HWY_INLINE Triplet minus(const Triplet& a, const Triplet& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
// kTripleProductError assumes this order of operations, without fused ones.
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

/// A ray's line against a triangle's edges, one edge per lane: ab with corner a, bc with b, ca with c, and the last one
/// again.
struct alignas(32) RaySides {
  double side[4];     // edge . (corner x direction), with the corner relative to the ray's start
  double edge2[4];    // squared edges
  double corner2[4];  // squared distances from the start to the corners
  double direction2;
};

/// Corners without an error.
struct NotOff {};
/// Corners with at most this error.
struct OffBy {
  double off_m;
};

/// Upper bound on the square of a side's error: |direction| (|edge| + 2 |corner| + 2 off_m) off_m.
HWY_INLINE double side_off2(OffBy by, double edges2, double corners2, double direction2) {
  const double off2 = by.off_m * by.off_m;
  return direction2 * off2 * (3 * edges2 + 12 * corners2 + 12 * off2) * (1 + kBoundSlack);
}

/// hit: the line certainly meets the triangle's interior.
template <class Off>
HWY_INLINE FilterVerdict sides_of(const Ray& ray, const Triangle& t, [[maybe_unused]] Off by, RaySides& out) {
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
  if (!(std::min({direction2, corners2, edges2}) >= kFilterLowest2)) return FilterVerdict::unsure;
  // Signed squares compare like the numbers, so no root is needed.
  double bound = kTripleProductError * kTripleProductError * edges2 * corners2 * direction2;
  // (a + b)^2 <= 2 a^2 + 2 b^2
  if constexpr (std::is_same_v<Off, OffBy>) bound = 2 * bound + 2 * side_off2(by, edges2, corners2, direction2);
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
  if (any_above && any_below) return FilterVerdict::miss;
  return all_above || all_below ? FilterVerdict::hit : FilterVerdict::unsure;
}

/// Divides the numbers pairwise, which takes as long as a single quotient.
HWY_INLINE void divide(const double (&above)[4], const double (&below)[4], double* out) {
  for (int first = 0; first < 4; first += kLanes) {
    const Lanes upper = lanes_of(above[0], above[1], above[2], above[3], first);
    hn::Store(hn::Div(upper, lanes_of(below[0], below[1], below[2], below[3], first)), kDoubles, out + first);
  }
}

/// Adds the error of the corners to the errors of the numerator and the denominator of the ray's parameter.
struct QuotientOff {
  double numerator = 0;
  double denominator = 0;
};
HWY_INLINE QuotientOff quotient_off(OffBy by, double ab2, double ca2, double to_a_m, double area, double length) {
  // Both edges of the normal are off by twice as much as a corner.
  const double normal_off = 2 * by.off_m * (std::sqrt(ab2) + std::sqrt(ca2) + 2 * by.off_m);
  return {((to_a_m + by.off_m) * normal_off + by.off_m * area) * (1 + kBoundSlack),
          length * normal_off * (1 + kBoundSlack)};
}

/// Where a line that certainly meets the triangle's interior meets it, and whether that is within the ray.
template <class Off>
HWY_INLINE FilterVerdict place_hit(const Ray& ray, const Triangle& triangle, const RaySides& s, [[maybe_unused]] Off by,
                                   RayHit& hit) {
  const Triple a = triple(triangle.a);
  const Triple to_a = a - triple(ray.origin);
  const Triple normal = cross(a - triple(triangle.c), triple(triangle.b) - a);
  const double numerator = dot(to_a, normal);
  const double denominator = dot(triple(ray.direction), normal);
  const double ab2 = s.edge2[0];
  const double ca2 = s.edge2[2];
  const double to_a2 = s.corner2[0];
  // The largest edge and corner distance are in range; the ones used here may still be tiny.
  if (!(std::min({ab2, ca2, to_a2}) >= kFilterLowest2)) return FilterVerdict::unsure;
  HWY_ALIGN double root[4];
  for (int first = 0; first < 4; first += kLanes) {
    const Lanes squares = lanes_of(ab2 * ca2, to_a2, s.direction2, dot(normal, normal), first);
    hn::Store(hn::Sqrt(squares), kDoubles, root + first);
  }
  const double area_scale = root[0];
  const double length = root[2];
  const double numerator_error = kTripleProductError * root[1] * area_scale;
  const double denominator_error = kTripleProductError * length * area_scale;
  const double size = std::abs(denominator);
  if constexpr (std::is_same_v<Off, OffBy>) {
    const QuotientOff off = quotient_off(by, ab2, ca2, root[1], area_scale, length);
    const double share = (off.numerator + numerator_error) / std::abs(numerator);
    const double below = (off.denominator + denominator_error) / size;
    if (!(share < 1) || !(below < 0.5)) return FilterVerdict::unsure;
    // Bound on the parameter's error, relative to it; twice that leaves room for the following roundings.
    const double most_m = std::abs(numerator / denominator) * length;
    const double off_m = 2 * most_m * (share + below) / (1 - below);
    const bool is_ahead = (numerator > 0) == (denominator > 0);
    if (is_ahead && !(most_m + off_m < ray.length_m) && !(most_m - off_m > ray.length_m)) return FilterVerdict::unsure;
  }
  if (!(std::abs(numerator) > numerator_error) || !(size > 2 * denominator_error)) return FilterVerdict::unsure;
  if ((numerator > 0) != (denominator > 0)) return FilterVerdict::miss;
  const double sides = s.side[1] + s.side[2] + s.side[0];
  HWY_ALIGN double found[4];  // the parameter, the factor that makes the normal a unit vector, the first two weights
  const double against = std::copysign(1.0, -denominator);  // without a branch, which would be unpredictable
  divide({numerator, against, s.side[1], s.side[2]}, {denominator, root[3], sides, sides}, found);
  HWY_ALIGN double part[4];  // relative errors
  divide({numerator_error, denominator_error, 0, 0}, {std::abs(numerator), size, 1, 1}, part);
  const double distance = found[0] * length;
  // A quotient whose terms have relative errors n and d errs by (n + d) / (1 - d); then follow quotient, norm and
  // product.
  const double relative = (part[0] + part[1]) / (1 - part[1]) * (1 + kBoundSlack) + 8 * kRoundoff;
  const double error = distance * relative;
  if (distance - error > ray.length_m) return FilterVerdict::miss;
  if (!(distance + error <= ray.length_m) || !std::isfinite(distance)) return FilterVerdict::unsure;
  if (relative > kRefineRay && !sharp({distance, error}, kRefineRay)) return FilterVerdict::blunt;
  hit.distance_m = distance;
  hit.distance_error_m = error;
  hit.exit_m = distance;
  hit.exit_error_m = error;
  hit.inside = false;
  hit.point = Vec3(ray.origin[0] + found[0] * ray.direction[0], ray.origin[1] + found[0] * ray.direction[1],
                   ray.origin[2] + found[0] * ray.direction[2]);
  hit.normal = Vec3(normal.x * found[1], normal.y * found[1], normal.z * found[1]);
  hit.weights = weights_of_parts(found[2], found[3]);
  return FilterVerdict::hit;
}

template <class Off>
HWY_INLINE FilterVerdict filtered(const Ray& ray, const Triangle& triangle, Off by, RayHit& hit) {
  RaySides sides;
  const FilterVerdict verdict = sides_of(ray, triangle, by, sides);
  return verdict == FilterVerdict::hit ? place_hit(ray, triangle, sides, by, hit) : verdict;
}

FilterVerdict FilterRay(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  return filtered(ray, triangle, NotOff{}, hit);
}
FilterVerdict FilterRayWithin(const Ray& ray, const Triangle& triangle, double off_m, RayHit& hit) {
  return filtered(ray, triangle, OffBy{off_m}, hit);
}

}  // namespace collided::engine::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::kernel {

HWY_EXPORT(FilterRay);
HWY_EXPORT(FilterRayWithin);

FilterVerdict filter_ray(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  return HWY_DYNAMIC_DISPATCH(FilterRay)(ray, triangle, hit);
}

FilterVerdict filter_ray_within(const Ray& ray, const Triangle& triangle, double off_m, RayHit& hit) {
  return HWY_DYNAMIC_DISPATCH(FilterRayWithin)(ray, triangle, off_m, hit);
}

}  // namespace collided::engine::kernel
#endif
