#include "server/exact_phase/part_convex.hpp"

#include <limits>

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/exact_phase/distance/convex_pair.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/overlap/overlap.hpp"

namespace collided::engine {
namespace {

using kernel::Convex;

Separation turned(Separation s) {
  std::swap(s.on_a, s.on_b);
  s.normal = -s.normal;
  return s;
}

/// The separation from a half-space's plane to the set's nearest point.
Separation above(const HalfSpace& ground, const Convex& set) {
  Separation result;
  result.normal = kernel::unit(ground.normal);
  const Bounded reach = kernel::reach_value(set, ground.normal, -1, ground.point);
  const Bounded gap = -reach / sqrt(square(kernel::Vector<Bounded>(ground.normal)));
  result.distance_m = std::max(gap.value, 0.0);
  result.error_m = gap.bound() + (result.distance_m - gap.value);
  result.on_b = set.carrier[0] + set.support(-result.normal) - set.ball_m * result.normal;
  result.on_a = result.on_b - result.distance_m * result.normal;
  const double extent = set.carrier[0].cwiseAbs().maxCoeff() + set.reach_m + ground.point.cwiseAbs().maxCoeff();
  result.point_error_m = result.error_m + kSupportError * extent;
  return result;
}

}  // namespace

Convex convex_of(const ConvexPart& part) {
  if (const auto* triangle = std::get_if<Triangle>(&part)) return Convex(*triangle);
  return std::visit(
      [](const auto& shape) {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, HalfSpace>) return Convex(Sphere{shape.point, 0});
        else return Convex(shape);
      },
      std::get<Primitive>(part));
}

Aabb bounds_of_part(const ConvexPart& part) {
  return std::visit([](const auto& shape) { return bounds(shape); }, part);
}

ExactResult overlaps(const ConvexPart& a, const ConvexPart& b) {
  return std::visit(
      [](const auto& first, const auto& second) {
        using First = std::decay_t<decltype(first)>;
        using Second = std::decay_t<decltype(second)>;
        if constexpr (std::is_same_v<First, Triangle> && std::is_same_v<Second, Primitive>)
          return overlaps(second, first);
        else return overlaps(first, second);
      },
      a, b);
}

Contact contact(const ConvexPart& a, const ConvexPart& b) {
  return std::visit(
      [](const auto& first, const auto& second) {
        using First = std::decay_t<decltype(first)>;
        using Second = std::decay_t<decltype(second)>;
        if constexpr (std::is_same_v<First, Triangle> && std::is_same_v<Second, Primitive>) {
          Contact found = contact(second, first);
          found.normal = -found.normal;
          return found;
        } else {
          return contact(first, second);
        }
      },
      a, b);
}

Separation separation(const ConvexPart& a, const ConvexPart& b) {
  const HalfSpace* ground_a = half_space_of(a);
  const HalfSpace* ground_b = half_space_of(b);
  if (ground_a != nullptr && ground_b != nullptr) return {.error_m = std::numeric_limits<double>::infinity()};
  if (ground_a != nullptr) return above(*ground_a, convex_of(b));
  if (ground_b != nullptr) return turned(above(*ground_b, convex_of(a)));
  return kernel::separation_of({convex_of(a), convex_of(b)});
}

}  // namespace collided::engine
