#include "server/world/query/ray_from_inside.hpp"

#include <limits>

#include "server/exact_phase/given/given_ray.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/geometry/stable_length.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/query/ray_in_frame.hpp"
#include "server/world/query/solid_hits.hpp"

namespace collided::engine {
namespace {

/// The nearest of the surface's triangles along the whole line of the ray, regardless of its length.
RayHit first_on_surface(const Ray& ray, const IndexedMesh& surface, const Placed& object, Question& question) {
  const Frame& frame = object.frame;
  const double off_m = object.pose != nullptr ? placing_error_m(frame, surface.radius_m) : 0;
  Ray endless = ray;
  endless.length_m = std::numeric_limits<double>::infinity();
  const double direction_m = stable_length(ray.direction);
  double limit = std::numeric_limits<double>::infinity();
  RayHit nearest{.distance_m = limit};
  const auto candidate = [&](std::uint32_t number) {
    if (question.deadline.is_over()) return limit = -1;
    RayHit hit;
    const Triangle own = surface.mesh->triangle(number);
    const Triangle placed = place(frame, own);
    ++question.exact_tests;
    const auto given = [&] { return GivenPart{.own = own, .pose = object.pose, .frame = &frame}; };
    if (!cast_ray_as_given(endless, placed, off_m, given, hit).yes() || hit.distance_m >= nearest.distance_m)
      return limit;
    hit.distance_error_m += placing_error_along(ray, hit, placing_error_m(frame, own), &placed);
    nearest = hit;
    return limit = (hit.distance_m + hit.distance_error_m) / direction_m * (1 + kFewSlack);
  };
  walk_ray_in_frame(endless, limit, {surface.tree, surface.radius_m, surface.mesh->triangles.size()}, frame,
                    question.walk, candidate);
  return nearest;
}

}  // namespace

std::optional<RayHit> hit_from_inside(const Ray& ray, const SolidMesh& solid, const Placed& object,
                                      Question& question) {
  const Aabb start{.low = ray.origin, .high = ray.origin};
  if (!overlaps(object.bounds, start) || question.deadline.is_over()) return std::nullopt;
  if (side_in_question(solid, object, ray.origin, question) != SolidSide::in) return std::nullopt;
  const RayHit exit = first_on_surface(ray, *solid.surface, object, question);
  if (question.deadline.was_over()) return std::nullopt;
  return RayHit{.point = ray.origin,
                .normal = -exit.normal,
                .exit_m = exit.distance_m,
                .exit_error_m = exit.distance_error_m,
                .inside = true};
}

}  // namespace collided::engine
