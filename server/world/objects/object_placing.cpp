#include "server/world/objects/object_placing.hpp"

#include "server/geometry/placing_error.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {

double placing_error_m(const Placed& object, std::uint32_t triangle, const Aabb& other) {
  const Frame& frame = object.frame;
  if (frame.position.isZero(0) && frame.rotation == Mat3::Identity() && object.info->primitives.empty()) return 0;
  if (triangle != kNoTriangle && object.info->mesh)
    return placing_error_m(frame, object.info->mesh->mesh->triangle(triangle));
  // Indexed primitives are spheres, capsules and boxes; a box has three errors: of its position, its rotation, and its
  // pose in its own frame.
  if (object.info->rare->parts && !object.info->mesh)
    return 3 * placing_error_m(frame, object.info->rare->parts->radius_m);
  double most_m = object.info->mesh ? placing_error_m(frame, object.info->mesh->radius_m) : 0;
  for (const Primitive& own : object.info->primitives) {
    double far_m = 0;
    if (const auto* ground = std::get_if<HalfSpace>(&own)) {
      const Vec3 point = place(frame, ground->point);
      far_m = (other.high - point).cwiseAbs().cwiseMax((other.low - point).cwiseAbs()).norm();
    }
    most_m = std::max(most_m, placing_error_m(frame, own, far_m));
  }
  return most_m;
}

double placing_error_m(const Placed& a, std::uint32_t a_triangle, const Placed& b, std::uint32_t b_triangle) {
  return (placing_error_m(a, a_triangle, b.bounds) + placing_error_m(b, b_triangle, a.bounds)) * (1 + kBoundSlack);
}

}  // namespace collided::engine
