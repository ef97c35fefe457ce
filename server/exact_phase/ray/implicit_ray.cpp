#include "server/exact_phase/ray/implicit_ray.hpp"

#include <array>

#include "server/exact_phase/ray/implicit_exact.hpp"
#include "server/exact_phase/ray/implicit_filter.hpp"
#include "server/exact_phase/ray/implicit_hit.hpp"

namespace collided::engine {
namespace {

using namespace kernel;

/// A unit normal with a larger error is computed again exactly: a hundredth of an arc second.
constexpr double kRefineNormal = 0x1p-24;

}  // namespace

ExactResult cast_ray(const Ray& ray, const ImplicitSurface& surface, ImplicitHit& hit, double relative_width) {
  const FilteredMeeting quick = first_meeting(ray, surface);
  const bool may_climb = precision.highest == Level::rational;
  if (quick.meets == Decision::no) return {Decision::no, Level::filter};
  if (quick.meets == Decision::yes) {
    hit.runs_along = false;
    set_place(ray, quick.low, quick.high, hit);
    const Vector<Bounded>& p = quick.point;
    const std::array<Bounded, 3> slope = gradient(surface, p.x, p.y, p.z);
    const double normal_error = set_normal({slope[0], slope[1], slope[2]}, hit);
    const bool sharp = narrow_enough(ray, quick.low, quick.high, relative_width) &&
                       (normal_error <= kRefineNormal || precision.error_asked_m > 0);
    if (sharp || !may_climb) return {Decision::yes, Level::filter};
    ++rungs.sharpened;
  } else {
    ++rungs.uncertain;
    if (!may_climb) return {Decision::undecided, Level::filter};
    ++rungs.rational;
  }
  return cast_ray_by_rationals(ray, surface, hit, relative_width);
}

ExactResult cast_ray_by_rationals(const Ray& ray, const ImplicitSurface& surface, ImplicitHit& hit,
                                  double relative_width) {
  return {first_meeting_exactly(ray, surface, relative_width, hit), Level::rational};
}

ExactResult side_of(const Vec3& point, const ImplicitSurface& surface, Side& side) {
  if ((point.array() < surface.low.array()).any() || (point.array() > surface.high.array()).any()) {
    side = Side::outside;
    return {Decision::yes, Level::filter};
  }
  return climb([&]<class N>() {
    const Sign s = sign(evaluate(surface, N(point[0]), N(point[1]), N(point[2])));
    if (s == Sign::unsure) return Decision::undecided;
    side = static_cast<Side>(s);
    return Decision::yes;
  });
}

}  // namespace collided::engine
