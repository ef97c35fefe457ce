#pragma once

#include <algorithm>
#include <limits>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"

namespace collided::bench {
using namespace engine;

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

struct ClosestHit {
  double s = std::numeric_limits<double>::infinity();  // along the ray, in units of its direction
  std::uint32_t triangle = kNoTriangle;
};

/// The first triangle along the ray, every candidate decided exactly, as the product does it.
inline ClosestHit closest_hit(const Bvh& tree, const TriangleMesh& mesh, const Ray& ray, WalkCost& cost) {
  const double direction_m = ray.direction.norm();
  ClosestHit best;
  const auto candidate = [&](std::uint32_t triangle, const Triangle& corners, double limit) {
    RayHit hit;
    if (!cast_ray(ray, corners, hit).yes()) return limit;
    const double s = hit.distance_m / direction_m;
    if (s < best.s) best = {s, triangle};
    return std::min(limit, (hit.distance_m + hit.distance_error_m) / direction_m * (1 + 0x1p-50));
  };
  tree.walk_ray(ray, std::numeric_limits<double>::infinity(), 0, mesh, candidate, cost);
  return best;
}

}  // namespace collided::bench
