#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::oracle {
using namespace engine;

/// What the plain forms did: roots are what costs most.
struct PlainSphereCost {
  std::uint64_t behind = 0;  // rejected: the sphere's centre lies behind a start outside it
  std::uint64_t beside = 0;  // rejected: the line passes it by
  std::uint64_t roots = 0;
};

// A ray of unit direction and a sphere in plain double, as textbooks have it twice. Both tell 0 for a start inside.

/// By the quadratic t^2 + 2 t b + c = 0, its smaller root as it stands.
inline std::optional<double> ray_sphere_by_quadratic(const Ray& ray, const Sphere& sphere, PlainSphereCost& cost) {
  const Vec3 from = ray.origin - sphere.center;
  const double b = from.dot(ray.direction);
  const double c = from.squaredNorm() - sphere.radius_m * sphere.radius_m;
  const double discriminant = b * b - c;
  if (discriminant < 0) {
    ++cost.beside;
    return std::nullopt;
  }
  ++cost.roots;
  const double root = std::sqrt(discriminant);
  if (-b - root >= 0) return -b - root;
  if (-b + root >= 0) return 0;
  ++cost.behind;
  return std::nullopt;
}

/// By early rejects: inside, behind, beside (Pythagoras), and a root only for what is left.
/// source  Akenine-Moeller, Haines, Hoffman, "Real-Time Rendering", the optimized ray/sphere test
inline std::optional<double> ray_sphere_by_rejects(const Ray& ray, const Sphere& sphere, PlainSphereCost& cost) {
  const Vec3 to_center = sphere.center - ray.origin;
  const double r2 = sphere.radius_m * sphere.radius_m;
  const double l2 = to_center.squaredNorm();
  if (l2 <= r2) return 0;
  const double along = to_center.dot(ray.direction);
  if (along < 0) {
    ++cost.behind;
    return std::nullopt;
  }
  const double across2 = l2 - along * along;
  if (across2 > r2) {
    ++cost.beside;
    return std::nullopt;
  }
  ++cost.roots;
  return along - std::sqrt(r2 - across2);
}

}  // namespace collided::oracle
