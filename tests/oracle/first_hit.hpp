#pragma once

#include <cstdint>
#include <limits>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/ray.hpp"

namespace collided::oracle {
using namespace engine;

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

/// The first triangle along a ray; of equally near ones the lowest number. s is in units of the direction's length.
struct FirstHit {
  std::uint32_t triangle = kNoTriangle;
  double s = std::numeric_limits<double>::infinity();

  friend bool operator==(const FirstHit&, const FirstHit&) = default;

  void take(const TriangleMesh& mesh, std::uint32_t number, const Ray& ray) {
    RayHit hit;
    if (!cast_ray(ray, mesh.triangle(number), hit).yes()) return;
    const double at = hit.distance_m / ray.direction.norm();
    if (at < s || (at == s && number < triangle)) *this = {number, at};
  }
};

/// What a plain tree's walk met.
struct PlainCost {
  std::uint64_t nodes = 0;
  std::uint64_t tests = 0;
};

/// No tree at all.
inline FirstHit first_hit(const TriangleMesh& mesh, const Ray& ray) {
  FirstHit first;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) first.take(mesh, i, ray);
  return first;
}

}  // namespace collided::oracle
