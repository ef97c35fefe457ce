#include "server/exact_phase/exactly.hpp"

#include <variant>

#include "server/exact_phase/closest_kernel.hpp"
#include "server/exact_phase/overlap_kernel.hpp"
#include "server/exact_phase/ray_box_kernel.hpp"
#include "server/exact_phase/ray_round_kernel.hpp"
#include "server/exact_phase/ray_triangle_kernel.hpp"

namespace collided::exactly {

using kernel::cast_facet;
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
        if constexpr (requires { sets_meet<Dyadic>(first, second); }) return sets_meet<Dyadic>(first, second);
        else return sets_meet<Dyadic>(second, first);
      },
      a, b);
}

Decision overlaps(const Primitive& a, const Triangle& b) {
  return std::visit([&](const auto& solid) { return sets_meet<Dyadic>(solid, b); }, a);
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
  return std::visit([&](const auto& solid) { return cast_solid<RationalsAlone>(ray, solid, hit).decision; }, primitive);
}

Closest closest(const Vec3& point, const Sphere& sphere) { return closest_by<RationalsAlone>(point, sphere); }
Closest closest(const Vec3& point, const Box& box) { return closest_by<RationalsAlone>(point, box); }
Closest closest(const Vec3& point, const Capsule& capsule) { return closest_by<RationalsAlone>(point, capsule); }
Closest closest(const Vec3& point, const Triangle& triangle) { return closest_by<RationalsAlone>(point, triangle); }
Closest closest(const Vec3& point, const Primitive& primitive) {
  return std::visit([&](const auto& solid) { return closest_by<RationalsAlone>(point, solid); }, primitive);
}

}  // namespace collided::exactly
