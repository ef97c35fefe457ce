#pragma once

#include <algorithm>
#include <limits>

#include "server/broad_phase/bsp_tree.hpp"
#include "server/exact_phase/ray_cast.hpp"

namespace collided::bench {
using namespace engine;

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

struct ClosestHit {
  double s = std::numeric_limits<double>::infinity();  // along the ray, in units of its direction
  std::uint32_t triangle = kNoTriangle;
};

/// The first triangle along the ray, every candidate decided exactly, as the product does it.
inline ClosestHit closest_hit(const BspTree& tree, const TriangleMesh& mesh, const Ray& ray, WalkCost& cost) {
  struct Context {
    const Ray& ray;
    double direction_m;
    ClosestHit best;
  } context{ray, ray.direction.norm(), {}};
  const auto candidate = [](void* raw, std::uint32_t triangle, const Triangle& corners, double limit) {
    Context& c = *static_cast<Context*>(raw);
    RayHit hit;
    if (!cast_ray(c.ray, corners, hit).yes()) return limit;
    const double s = hit.distance_m / c.direction_m;
    if (s < c.best.s) c.best = {s, triangle};
    return std::min(limit, (hit.distance_m + hit.distance_error_m) / c.direction_m * (1 + 0x1p-50));
  };
  tree.walk_ray(ray, std::numeric_limits<double>::infinity(), 0, mesh, candidate, &context, cost);
  return context.best;
}

}  // namespace collided::bench
