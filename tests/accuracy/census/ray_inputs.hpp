#pragma once

#include <utility>

#include "tests/accuracy/census/inputs.hpp"

namespace collided::census {
using namespace engine;

// What rays are asked about: a ray and a shape of one family.

/// A direction whose length is whole: any of these, mirrored and swapped, times a factor.
inline GridPoint whole_direction(Maker& make) {
  static constexpr std::int64_t kQuadruples[][3] = {{1, 2, 2}, {2, 3, 6},  {1, 4, 8}, {4, 4, 7}, {2, 6, 9},
                                                    {6, 6, 7}, {3, 4, 12}, {0, 3, 4}, {0, 0, 1}};
  const auto& q = kQuadruples[make.whole(0, 8)];
  const auto first = static_cast<std::size_t>(make.whole(0, 2));
  GridPoint d;
  for (std::size_t k = 0; k < 3; ++k) d[(first + k) % 3] = (make.whole(0, 1) == 0 ? 1 : -1) * q[k];
  return d;
}

inline std::int64_t length_of(const GridPoint& d) {
  return std::llround(std::sqrt(static_cast<double>(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])));
}

/// From a random origin through `target`, or (one in four) from a grid point behind it along a direction of whole
/// length, ending at the target, one step before it or one after.
inline RayInput ray_through(Maker& make, const GridPoint& target) {
  if (make.whole(0, 3) != 0) {
    RayInput ray{make.point(), {}};
    ray.direction = target + make.nudged() - ray.origin;
    if (ray.direction == GridPoint{0, 0, 0}) ray.direction = {1, 0, 0};
    return ray;
  }
  const GridPoint d = whole_direction(make);
  const std::int64_t steps = make.whole(0, make.family() == Family::lattice ? 2 : 1 << 18);
  return {target - steps * d, d, (steps + make.nudge() > 0 ? steps + make.nudge() : 0) * length_of(d)};
}

inline RayInput any_ray(Maker& make) {
  RayInput ray{make.point(), make.step()};
  while (ray.direction == GridPoint{0, 0, 0}) ray.direction = make.step();
  return ray;
}

/// In the triangle's plane, or off it by one step in 2^20.
inline RayInput grazing_ray(Maker& make, const TriangleInput& t) {
  RayInput ray{t.a + 3 * (t.b - t.a) - 2 * (t.c - t.a) + make.nudged(), {}};
  ray.direction = make.summand(make.on(t)) - ray.origin;
  if (ray.direction == GridPoint{0, 0, 0}) ray.direction = {0, 0, 1};
  return ray;
}

inline auto triangle_case(Maker& make) {
  const TriangleInput t = make.triangle();
  if (!make.aims()) return std::pair{any_ray(make), t};
  const bool graze = make.whole(0, 3) == 0;
  return std::pair{graze ? grazing_ray(make, t) : ray_through(make, make.on(t)), t};
}

inline RayInput ray_towards(Maker& make, const GridPoint& target) {
  RayInput ray{make.point(), {}};
  ray.direction = target - ray.origin;
  if (ray.direction == GridPoint{0, 0, 0}) ray.direction = {1, 0, 0};
  return ray;
}

/// Exactly through a corner: always a hit.
inline auto vertex_case(Maker& make) {
  const TriangleInput t = make.triangle();
  return std::pair{ray_towards(make, t.b), t};
}

/// Exactly through an edge: always a hit.
inline auto edge_case(Maker& make) {
  const TriangleInput t = make.triangle();
  GridPoint target = t.a;
  const std::int64_t i = make.whole(1, 7);
  for (std::size_t k = 0; k < 3; ++k) target[k] += i * (t.b[k] - t.a[k]) / 8;
  return std::pair{ray_towards(make, target), t};
}

inline auto grazing_case(Maker& make) {
  const TriangleInput t = make.triangle();
  return std::pair{grazing_ray(make, t), t};
}

inline auto box_case(Maker& make) {
  const BoxInput b = make.box();
  return std::pair{make.aims() ? ray_through(make, make.on(b)) : any_ray(make), b};
}

/// The radius is worked out from the ray's line, so that the ray is a tangent but for one step.
inline auto ball_case(Maker& make) {
  BallInput ball = make.ball();
  if (!make.aims()) return std::pair{any_ray(make), ball};
  const RayInput ray = make.whole(0, 1) == 0 ? any_ray(make) : ray_through(make, make.point());
  const Fraction<WideInt<8>> squared =
      squared_distance_to_ray<WideInt<8>>(ray.origin, ray.direction, ball.center, ball.center);
  ball.radius = touching_radius(make, approximate(squared.numerator) / approximate(squared.denominator));
  return std::pair{ray, ball};
}

inline auto pill_case(Maker& make) {
  PillInput pill = make.pill();
  if (!make.aims()) return std::pair{any_ray(make), pill};
  const RayInput ray = make.whole(0, 1) == 0 ? any_ray(make) : ray_through(make, make.point());
  const Fraction<WideInt<8>> squared = squared_distance_to_ray<WideInt<8>>(ray.origin, ray.direction, pill.a, pill.b);
  pill.radius = touching_radius(make, approximate(squared.numerator) / approximate(squared.denominator));
  return std::pair{ray, pill};
}

}  // namespace collided::census
