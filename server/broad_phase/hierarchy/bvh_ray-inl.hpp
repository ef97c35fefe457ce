// Prepares a ray for the walk, for each instruction set: in the tree's own frame, in float, with every rounding covered
// by its slack. Included once per target, like Highway's own -inl files.
#if defined(COLLIDED_BVH_RAY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef COLLIDED_BVH_RAY_INL
#undef COLLIDED_BVH_RAY_INL
#else
#define COLLIDED_BVH_RAY_INL
#endif

#include <hwy/highway.h>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_ray.hpp"
#include "server/geometry/tolerance.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::bvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Three axes and a spare lane.
using Axes = hn::CappedTag<double, 4>;
using AxesFloat = hn::Rebind<float, Axes>;

/// A vector in the first three lanes, zero in the spare one. Loaded as single numbers: they were usually written just
/// before, one by one, and a wider load would wait until those stores have reached the cache.
HWY_INLINE hn::Vec<Axes> axes_of([[maybe_unused]] const Vec3& v) {
  constexpr Axes axes;
#if HWY_TARGET != HWY_SCALAR
  if constexpr (hn::MaxLanes(axes) == 4) {
    constexpr hn::Half<Axes> pair;
    const auto low = hn::InterleaveLower(pair, hn::Set(pair, v[0]), hn::Set(pair, v[1]));
    return hn::Combine(axes, hn::InterleaveLower(pair, hn::Set(pair, v[2]), hn::Zero(pair)), low);
  }
#endif
  return hn::Zero(axes);
}

/// The planes of a node that the ray meets first and last on each axis, as byte offsets, and the octant of its
/// direction.
HWY_INLINE void set_plane_offsets(hn::Vec<AxesFloat> inverse, RayFrame& out) {
  constexpr AxesFloat floats;
  using Offsets = hn::RebindToUnsigned<AxesFloat>;
  constexpr Offsets offsets;
  const auto axis_bytes = hn::Mul(hn::Iota(offsets, 0), hn::Set(offsets, 2 * kPlaneBytes));
  const auto upper = hn::And(hn::ShiftRight<26>(hn::BitCast(offsets, inverse)), hn::Set(offsets, kPlaneBytes));
  static_assert(offsetof(Node, plane) == 0 && kPlaneBytes == 1u << 5);
  hn::Store(hn::Add(axis_bytes, upper), offsets, out.near_plane);
  hn::Store(hn::Add(axis_bytes, hn::Xor(upper, hn::Set(offsets, kPlaneBytes))), offsets, out.far_plane);
  std::uint8_t backward[8] = {};
  hn::StoreMaskBits(floats, hn::Lt(inverse, hn::Zero(floats)), backward);
  out.octant = backward[0] & 7u;
}

/// The fast path of prepare_any_ray for usual rays, taking each error as the worst of its kind; false if the ray is not
/// usual. Most rays have no slack.
template <bool kSlack>
HWY_INLINE bool prepare_usual_ray(const Layout& layout, const Ray& ray, double slack_m, RayFrame& out) {
  using namespace ray_detail;
  constexpr Axes axes;
  constexpr AxesFloat floats;
  if constexpr (hn::MaxLanes(axes) < 4) return false;
  static_assert(offsetof(LocalFrame, origin) == 0 && offsetof(LocalFrame, scale) == 3 * sizeof(double));
  const LocalFrame& frame = layout.frame;
  // The load also takes the scale into the spare lane.
  const auto away = hn::Sub(axes_of(ray.origin), hn::LoadU(axes, &frame.origin[0]));
  const auto local = hn::IfThenElseZero(hn::FirstN(axes, 3), hn::Mul(away, hn::Set(axes, frame.scale)));
  const auto direction = axes_of(ray.direction);
  const auto largest = hn::MaxOfLanes(axes, hn::Abs(direction));
  const int exponent = exponent_of(hn::GetLane(largest));
  const double slack = kSlack ? slack_m * frame.scale * (1 + kFewSlack) : 0;
  const bool near = hn::AllTrue(axes, hn::Le(hn::Abs(local), hn::Set(axes, kNear)));
  if (!near || !is_usual(exponent, frame.scale_exponent) || !(slack < 1)) return false;

  const auto origin = hn::DemoteTo(floats, local);
  // 2^-exponent: the exponent fields of both add up to 2046.
  using Words = hn::RebindToUnsigned<Axes>;
  constexpr Words words;
  const auto field = hn::And(hn::BitCast(words, largest), hn::Set(words, std::uint64_t{0x7ff} << 52));
  const auto scale = hn::BitCast(axes, hn::Sub(hn::Set(words, std::uint64_t{2046} << 52), field));
  const auto rounded = hn::DemoteTo(floats, hn::Mul(direction, scale));
  const auto clamped =
      hn::CopySign(hn::Max(hn::Abs(rounded), hn::Set(floats, static_cast<float>(kLeastDirection))), rounded);
  const auto inverse = hn::Div(hn::Set(floats, 1.0f), clamped);
  // Roundings in u: the start 1 |o|; the inverse 2 (|o| + 1); the offset's sum and product 2 |o|; in the walk the
  // product 1, the difference 1 + |o|. One percent more for their products with each other.
  const auto wide = hn::MulAdd(hn::Abs(origin), hn::Set(floats, static_cast<float>(6.1 * kUnit)),
                               hn::Set(floats, static_cast<float>(4.1 * kUnit + 2 * kLeastSlack + 1.01 * slack)));
  const auto shift = hn::CopySign(wide, inverse);
  hn::Store(origin, floats, out.origin);
  hn::Store(clamped, floats, out.direction);
  hn::Store(inverse, floats, out.inverse);
  hn::Store(hn::Mul(hn::Add(origin, shift), inverse), floats, out.near_offset);
  hn::Store(hn::Mul(hn::Sub(origin, shift), inverse), floats, out.far_offset);

  set_plane_offsets(inverse, out);

  // The spare lane of the start is zero, that of the direction tiny.
  const float reach = hn::GetLane(hn::MaxOfLanes(floats, hn::Abs(origin)));
  if constexpr (!kSlack) {
    set_usual_leaf_slack(reach, hn::GetLane(hn::MaxOfLanes(floats, hn::Abs(clamped))), out);
  } else {
    set_leaf_slack(kUnit * 1.001 * static_cast<double>(reach) + 2 * kLeastSlack, slack, out);
  }
  out.is_moved = false;
  out.to_local_1 = power_of_two(exponent + frame.scale_exponent);
  return true;
}

/// The ray in the tree's frame; false if it cannot meet anything.
HWY_INLINE bool prepare_ray(const Layout& layout, const Ray& ray, double slack_m, RayFrame& out) {
  const bool is_usual =
      slack_m == 0 ? prepare_usual_ray<false>(layout, ray, 0, out) : prepare_usual_ray<true>(layout, ray, slack_m, out);
  return is_usual || ray_detail::prepare_any_ray(layout, ray, slack_m, out);
}

}  // namespace collided::engine::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
