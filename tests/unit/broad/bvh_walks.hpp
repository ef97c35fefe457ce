#pragma once

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Numbers = std::set<std::uint32_t>;

/// Every candidate of a walk that never shortens.
inline Numbers along_ray(const Bvh& tree, const Ray& ray, double limit = kInfinity, double slack_m = 0) {
  Numbers all;
  WalkCost cost;
  const auto collect = [&](std::uint32_t triangle, double current) {
    all.insert(triangle);
    return current;
  };
  tree.walk_ray(ray, limit, slack_m, collect, cost);
  EXPECT_EQ(all.empty(), cost.candidates == 0);
  return all;
}

inline Vec3 in_cube(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return {x, y, coordinate(random)};
}

inline Aabb bounds_of(const TriangleMesh& mesh) {
  Aabb bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  return bounds;
}

/// Through points of triangles, their corners and edges, or at random; from `far` scene sizes away; some with zero
/// components, some starting on what they aim at.
inline Ray random_ray(const TriangleMesh& mesh, const Aabb& bounds, double far, std::mt19937_64& random) {
  const Triangle triangle = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
  const Vec3 center = bounds.low / 2 + bounds.high / 2;
  const Vec3 half = bounds.high / 2 - bounds.low / 2;
  Vec3 target = center + half.cwiseProduct(in_cube(random));
  switch (random() % 5) {
    case 0: target = triangle.a; break;
    case 1: target = triangle.a / 2 + triangle.b / 2; break;
    case 2: target = triangle.a / 3 + triangle.b / 3 + triangle.c / 3; break;
    case 3: target = triangle.c; break;
    default: break;
  }
  Vec3 origin = center + far * half.maxCoeff() * in_cube(random);
  const std::uint64_t zeros = random() % 8;
  if (zeros < 3) origin[static_cast<int>(zeros)] = target[static_cast<int>(zeros)];
  if (zeros == 3) origin[0] = target[0], origin[1] = target[1];
  if (zeros == 4) origin = target;
  Ray ray{origin, target - origin};
  if (ray.direction.isZero(0)) ray.direction = in_cube(random);
  if (zeros < 3 && random() % 2 == 0) ray.direction[static_cast<int>(zeros)] = -0.0;
  return ray;
}

/// Triangles that the ray meets, decided exactly.
inline Numbers met_by(const Ray& ray, const TriangleMesh& mesh) {
  Numbers all;
  RayHit hit;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (cast_ray(ray, mesh.triangle(i), hit).yes()) all.insert(i);
  }
  return all;
}

struct Count {
  std::size_t met = 0;
  std::size_t candidates = 0;
};

inline Count expect_none_lost(const TriangleMesh& mesh, double far, int ray_count, std::mt19937_64& random) {
  const Bvh tree = Bvh::build(mesh);
  const Aabb bounds = bounds_of(mesh);
  Count count;
  for (int i = 0; i < ray_count; ++i) {
    const Ray ray = random_ray(mesh, bounds, far, random);
    const Numbers expected = met_by(ray, mesh);
    const Numbers found = along_ray(tree, ray);
    EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end()))
        << "ray " << i << std::hexfloat << " from " << ray.origin.transpose() << " along " << ray.direction.transpose();
    count.met += expected.size();
    count.candidates += found.size();
  }
  EXPECT_GT(count.met, 0u);
  return count;
}

inline Aabb bounds_of(const Triangle& t) { return {t.a.cwiseMin(t.b).cwiseMin(t.c), t.a.cwiseMax(t.b).cwiseMax(t.c)}; }

inline Numbers in_box(const Bvh& tree, const Aabb& asked) {
  Numbers all;
  WalkCost cost;
  const auto collect = [&](std::uint32_t triangle) {
    all.insert(triangle);
    return true;
  };
  tree.walk_box(asked, collect, cost);
  return all;
}

inline Numbers in_box_by_force(const TriangleMesh& mesh, const Aabb& asked) {
  Numbers all;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (overlaps(bounds_of(mesh.triangle(i)), asked)) all.insert(i);
  }
  return all;
}

inline Numbers near_point(const Bvh& tree, const Vec3& point, double limit_m2, double slack_m = 0) {
  Numbers all;
  WalkCost cost;
  const auto collect = [&](std::uint32_t triangle, double limit) {
    all.insert(triangle);
    return limit;
  };
  tree.walk_near(point, limit_m2, slack_m, collect, cost);
  return all;
}

inline bool box_near(const Aabb& box, const Vec3& point, double limit_m) {
  return (box.low - point).cwiseMax(point - box.high).cwiseMax(0.0).stableNorm() <= limit_m;
}

/// Triangles surely within the limit, by the exact phase; boxes spare it the far ones.
inline Numbers near_by_force(const TriangleMesh& mesh, const Vec3& point, double limit_m) {
  Numbers all;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle triangle = mesh.triangle(i);
    if (!box_near(bounds_of(triangle), point, limit_m * (1 + 1e-9))) continue;
    const Closest nearest = closest(point, triangle);
    if (nearest.distance_m + nearest.distance_error_m <= limit_m) all.insert(i);
  }
  return all;
}

/// Triangles whose bounds are within the limit: what a walk over boxes could tell.
inline std::size_t boxes_near(const TriangleMesh& mesh, const Vec3& point, double limit_m) {
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    count += box_near(bounds_of(mesh.triangle(i)), point, limit_m);
  }
  return count;
}

}  // namespace collided::engine
