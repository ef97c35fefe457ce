// What comes with a ray's hit on a triangle, and what does not come through a closed mesh.  // A36 A37
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/plain_ray.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine::ray_triangle_weights_test {
namespace {

using oracle::Family;

// A36: the weights are not negative, their sum is 1 to a rounding, and with them the corners give the hit's point.
TEST(ExactRayTriangleWeights, AreNotNegativeSumToOneAndPlaceThePoint) {
  std::mt19937_64 random = oracle::seeded(36);
  int hits = 0;
  for (const Family family : {Family::random, Family::lattice, Family::tenths}) {
    oracle::RandomShapes shapes(random, family);
    for (int i = 0; i < 100'000; ++i) {
      const Triangle t = shapes.triangle();
      const Vec3 normal = (t.b - t.a).cross(t.c - t.a);
      const Ray ray = shapes.ray(false);
      // A ray in the triangle's plane, or nearly: its point is not known well in any form.
      if (!(std::abs(normal.dot(ray.direction)) > 1e-3 * ray.direction.norm())) continue;
      RayHit hit;
      if (!cast_ray(ray, t, hit).yes()) continue;
      ++hits;
      ASSERT_GE(hit.weights.minCoeff(), 0) << oracle::name(family) << " " << i;
      ASSERT_LE(std::abs(hit.weights.sum() - 1), 0x1p-52) << oracle::name(family) << " " << i;
      const Vec3 placed = hit.weights[0] * t.a + hit.weights[1] * t.b + hit.weights[2] * t.c;
      const double size = 1 + t.a.cwiseAbs().maxCoeff() + t.b.cwiseAbs().maxCoeff() + t.c.cwiseAbs().maxCoeff();
      ASSERT_LE((placed - hit.point).norm(), point_error_m(hit) + 1e-11 * size) << oracle::name(family) << " " << i;
    }
  }
  EXPECT_GT(hits, 5'000);
}

/// From within a closed mesh at one of its corners or at a point of an edge.
Ray at_a_seam(const TriangleMesh& mesh, std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(0, 1), inside(-0.25, 0.25);
  const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
  const Vec3 target = random() % 4 == 0 ? t.a : Vec3(t.a + part(random) * (t.b - t.a));
  const Vec3 from(inside(random), inside(random), inside(random));
  return {from, target - from};
}

// A37: the plain solution of three equations asks u >= 0, v >= 0, u + v <= 1 of rounded numbers, and a ray at an edge
// can fall between two triangles. 1e8 such rays: accuracy/leaks_long.
TEST(ExactRayTriangleWeights, NothingLeaksThroughAClosedMeshAndThePlainFormDoes) {
  std::mt19937_64 random = oracle::seeded(37);
  const TriangleMesh mesh = scenes::icosphere(2, 1);
  int leaks = 0;
  int plain_leaks = 0;
  constexpr int kRays = 20'000;
  for (int i = 0; i < kRays; ++i) {
    const Ray ray = at_a_seam(mesh, random);
    bool met = false;
    bool plain_met = false;
    for (std::uint32_t number = 0; number < mesh.triangles.size(); ++number) {
      const Triangle t = mesh.triangle(number);
      plain_met = plain_met || oracle::plain_ray(ray, t).has_value();
      RayHit hit;
      met = met || cast_ray(ray, t, hit).yes();
      if (met && plain_met) break;
    }
    leaks += met ? 0 : 1;
    plain_leaks += plain_met ? 0 : 1;
  }
  std::printf("of %d rays at edges and corners leak: %d, by the plain form %d\n", kRays, leaks, plain_leaks);
  EXPECT_EQ(leaks, 0);
  EXPECT_GT(plain_leaks, 0) << "the rays do not tempt";
}

}  // namespace
}  // namespace collided::engine::ray_triangle_weights_test
