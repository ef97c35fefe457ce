#pragma once

#include "server/exact_phase/given/given_part.hpp"
#include "server/exact_phase/part.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/exact_phase/ray/ray_triangle_filter.hpp"

namespace collided::engine {

/// True if the answer of double for a placed part (yes or no, and whether the ray begins inside) holds for every part
/// whose points differ from the placed ones by at most off_m.
///
/// verdict, hit  what cast_ray found
/// cost          some 10 to 50 ns; for a hull, or for a near miss, that of two pairs of convex shapes
bool holds_within(const Ray& ray, const Sphere& placed, double off_m, const ExactResult& verdict, const RayHit& hit);
bool holds_within(const Ray& ray, const Box& placed, double off_m, const ExactResult& verdict, const RayHit& hit);
bool holds_within(const Ray& ray, const Ellipsoid& placed, double off_m, const ExactResult& verdict, const RayHit& hit);
bool holds_within(const Ray& ray, const Capsule& placed, double off_m, const ExactResult& verdict, const RayHit& hit);
bool holds_within(const Ray& ray, const Cylinder& placed, double off_m, const ExactResult& verdict, const RayHit& hit);
bool holds_within(const Ray& ray, const Cone& placed, double off_m, const ExactResult& verdict, const RayHit& hit);
bool holds_within(const Ray& ray, const HalfSpace& placed, double off_m, const ExactResult& verdict, const RayHit& hit);
bool holds_within(const Ray& ray, const ConvexPart& placed, double off_m, const ExactResult& verdict,
                  const RayHit& hit);

/// Whether a ray meets a part placed exactly, decided like overlaps_as_given(). On yes the hit is that of the exact
/// part: distance and exit are found by bisection, and their bounds contain the truth.
///
/// hit      in: that of the placed part, if it meets the ray. The weights and the normal are close to those at the
///          exact hit
/// off_m    as in holds_within, above 0
/// returns  the verdict for the placed part if the rationals leave it open; undecided if the thread's Precision forbids
///          rationals
/// cost     50 us to some ms, more for cylinders, cones and ellipsoids; allocates
ExactResult ray_as_given(const Ray& ray, const ConvexPart& placed, const GivenPart& given, double off_m,
                         ExactResult verdict, RayHit& hit);

/// Same as cast_ray, for the exactly placed part. The distance is that of the placed part if its answer certainly holds
/// for the given one; placing_error_along bounds the difference.
///
/// given_of  called in doubt only
/// cost      a triangle: that of cast_ray; else that of cast_ray and holds_within; ray_as_given in doubt
/// threads   pure; allocates in doubt
template <class Part, class GivenOf>
ExactResult cast_ray_as_given(const Ray& ray, const Part& placed, double off_m, const GivenOf& given_of, RayHit& hit) {
  if (off_m == 0) return cast_ray(ray, placed, hit);
  if constexpr (std::is_same_v<Part, Triangle>) {
    switch (kernel::filter_ray_within(ray, placed, off_m, hit)) {
      case kernel::FilterVerdict::miss: return {Decision::no, Level::filter};
      case kernel::FilterVerdict::hit: return {Decision::yes, Level::filter};
      case kernel::FilterVerdict::blunt: return cast_ray(ray, placed, hit);
      default: break;
    }
  }
  const ExactResult verdict = cast_ray(ray, placed, hit);
  if constexpr (!std::is_same_v<Part, Triangle>) {
    if (holds_within(ray, placed, off_m, verdict, hit)) return verdict;
  }
  return ray_as_given(ray, as_part(placed), given_of(), off_m, verdict, hit);
}

}  // namespace collided::engine
