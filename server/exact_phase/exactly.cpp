#include "server/exact_phase/exactly.hpp"

#include <variant>

#include "server/exact_phase/distance/closest_kernel.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/distance/half_space_kernel.hpp"
#include "server/exact_phase/kernels/overlap_kernel.hpp"
#include "server/exact_phase/ray/ray_box_kernel.hpp"
#include "server/exact_phase/ray/ray_quadric_kernel.hpp"
#include "server/exact_phase/ray/ray_round_kernel.hpp"
#include "server/exact_phase/ray/ray_triangle_kernel.hpp"

namespace collided::engine::exactly {

using kernel::cast_facet;
using kernel::cast_quadric;
using kernel::cast_solid;
using kernel::closest_by;
using kernel::RationalsAlone;
using kernel::sets_meet;

Decision overlaps(const Sphere& a, const Sphere& b) { return sets_meet<Dyadic>(a, b); }
Decision overlaps(const Sphere& a, const Box& b) { return sets_meet<Dyadic>(a, b); }
Decision overlaps(const Sphere& a, const Capsule& b) { return sets_meet<Dyadic>(a, b); }
Decision overlaps(const Sphere& a, const Triangle& b) { return sets_meet<Dyadic>(a, b); }
Decision overlaps(const Box& a, const Box& b) { return sets_meet<Dyadic>(a, b); }
Decision overlaps(const Box& a, const Capsule& b) { return sets_meet<Dyadic>(a, b); }
Decision overlaps(const Box& a, const Triangle& b) { return sets_meet<Dyadic>(a, b); }
Decision overlaps(const Capsule& a, const Capsule& b) { return sets_meet<Dyadic>(a, b); }
Decision overlaps(const Capsule& a, const Triangle& b) { return sets_meet<Dyadic>(a, b); }
Decision overlaps(const Triangle& a, const Triangle& b) { return sets_meet<Dyadic>(a, b); }

Decision overlaps(const Primitive& a, const Primitive& b) {
  return std::visit(
      [](const auto& first, const auto& second) {
        using First = std::decay_t<decltype(first)>;
        using Second = std::decay_t<decltype(second)>;
        if constexpr (std::is_same_v<First, HalfSpace> || std::is_same_v<Second, HalfSpace>)
          return overlaps_half_space_by_rationals(first, second);
        else if constexpr (General<First> || General<Second>) return overlaps_by_rationals(&first, &second);
        else if constexpr (requires { sets_meet<Dyadic>(first, second); }) return sets_meet<Dyadic>(first, second);
        else return sets_meet<Dyadic>(second, first);
      },
      a, b);
}

Decision overlaps(const Primitive& a, const Triangle& b) {
  return std::visit(
      [&](const auto& solid) {
        using Solid = std::decay_t<decltype(solid)>;
        if constexpr (std::is_same_v<Solid, HalfSpace>) return overlaps_half_space_by_rationals(solid, b);
        else if constexpr (General<Solid>) return overlaps_by_rationals(&solid, &b);
        else return sets_meet<Dyadic>(solid, b);
      },
      a);
}

Decision cast_ray(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  return cast_facet<Dyadic>(ray, triangle, hit);
}
Decision cast_ray(const Ray& ray, const Sphere& sphere, RayHit& hit) {
  return cast_solid<RationalsAlone>(ray, sphere, hit).decision;
}
Decision cast_ray(const Ray& ray, const Box& box, RayHit& hit) {
  return cast_solid<RationalsAlone>(ray, box, hit).decision;
}
Decision cast_ray(const Ray& ray, const Capsule& capsule, RayHit& hit) {
  return cast_solid<RationalsAlone>(ray, capsule, hit).decision;
}
Decision cast_ray(const Ray& ray, const Primitive& primitive, RayHit& hit) {
  return std::visit(
      [&](const auto& solid) {
        using Solid = std::decay_t<decltype(solid)>;
        if constexpr (std::is_same_v<Solid, Hull>) return engine::cast_ray(ray, solid, hit).decision;
        else if constexpr (std::is_same_v<Solid, HalfSpace>)
          return kernel::cast_half_space<RationalsAlone>(ray, solid, hit).decision;
        else if constexpr (General<Solid>) return cast_quadric<RationalsAlone>(ray, solid, hit).decision;
        else return cast_solid<RationalsAlone>(ray, solid, hit).decision;
      },
      primitive);
}

Closest closest(const Vec3& point, const Sphere& sphere) { return closest_by<RationalsAlone>(point, sphere); }
Closest closest(const Vec3& point, const Box& box) { return closest_by<RationalsAlone>(point, box); }
Closest closest(const Vec3& point, const Capsule& capsule) { return closest_by<RationalsAlone>(point, capsule); }
Closest closest(const Vec3& point, const Triangle& triangle) { return closest_by<RationalsAlone>(point, triangle); }
Closest closest(const Vec3& point, const Primitive& primitive) {
  return std::visit(
      [&](const auto& solid) {
        using Solid = std::decay_t<decltype(solid)>;
        if constexpr (std::is_same_v<Solid, HalfSpace>) return kernel::closest_half_space<RationalsAlone>(point, solid);
        else if constexpr (General<Solid>) return engine::closest(point, solid);
        else return closest_by<RationalsAlone>(point, solid);
      },
      primitive);
}

}  // namespace collided::engine::exactly
