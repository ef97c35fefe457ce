#include "server/exact_phase/distance/closest.hpp"

#include <variant>

#include "server/exact_phase/distance/closest_kernel.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/half_space.hpp"

namespace collided::engine {
namespace kernel {

Vec3 nearest_face_normal(const Vec3& point, const Box& box) {
  Vec3 best = Vec3::UnitX();
  double best_depth = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    Vec3 normal = unit(Vec3(unit(Vec3(box.axes.col((i + 1) % 3))).cross(unit(Vec3(box.axes.col((i + 2) % 3))))));
    const double along = normal.dot(point - box.center);
    if (along < 0) normal = -normal;
    const double depth = box.half_m[i] * std::abs(normal.dot(box.axes.col(i))) - std::abs(along);
    if (depth >= best_depth) continue;
    best_depth = depth;
    best = normal;
  }
  return best;
}

}  // namespace kernel

using kernel::closest_by;
using kernel::WholeLadder;

Closest closest(const Vec3& point, const Sphere& sphere) { return closest_by<WholeLadder>(point, sphere); }
Closest closest(const Vec3& point, const Box& box) { return closest_by<WholeLadder>(point, box); }
Closest closest(const Vec3& point, const Capsule& capsule) { return closest_by<WholeLadder>(point, capsule); }
Closest closest(const Vec3& point, const Triangle& triangle) { return closest_by<WholeLadder>(point, triangle); }

Closest closest(const Vec3& point, const Primitive& primitive) {
  return std::visit([&](const auto& shape) { return closest(point, shape); }, primitive);
}

}  // namespace collided::engine
