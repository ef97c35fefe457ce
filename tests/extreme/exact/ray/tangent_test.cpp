#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::tangent_test {
namespace {

using extreme::down;
using extreme::up;

TEST(ExtremeRayTangent, AHundredMillionRadiiAwayOneStepDecides) {
  RayHit hit;
  for (const double x : {1.0, 1e3, 1e8, 1e15, 1e100, 1e300}) {
    EXPECT_TRUE(cast_ray({{-x, 1, 0}, {1, 0, 0}}, Sphere{{0, 0, 0}, 1}, hit).yes()) << x;
    EXPECT_LE(std::abs(hit.distance_m - x), hit.distance_error_m);
    EXPECT_LE(hit.distance_error_m, 2e-10 * x);
    EXPECT_FALSE(cast_ray({{-x, up(1.0), 0}, {1, 0, 0}}, Sphere{{0, 0, 0}, 1}, hit).yes()) << x;
    EXPECT_TRUE(cast_ray({{-x, 1, 0.5}, {1, 0, 0}}, Capsule{{0, 0, -1}, {0, 0, 1}, 1}, hit).yes()) << x;
    EXPECT_LE(std::abs(hit.distance_m - x), hit.distance_error_m);
    EXPECT_LE(hit.distance_error_m, 2e-10 * x);
    EXPECT_FALSE(cast_ray({{-x, up(1.0), 0.5}, {1, 0, 0}}, Capsule{{0, 0, -1}, {0, 0, 1}, 1}, hit).yes()) << x;
    EXPECT_TRUE(cast_ray({{-x, 1, 0.5}, {1, 0, 0}}, Box{{0, 0, 0}, Mat3::Identity(), {1, 1, 1}}, hit).yes()) << x;
    EXPECT_FALSE(cast_ray({{-x, up(1.0), 0.5}, {1, 0, 0}}, Box{{0, 0, 0}, Mat3::Identity(), {1, 1, 1}}, hit).yes())
        << x;
  }
}

// 3-4-5: touches the sphere at (3, 4, 0) along (4, -3, 0), no coordinate axis involved.
TEST(ExtremeRayTangent, SlantedTangent) {
  RayHit hit;
  EXPECT_TRUE(cast_ray({{3 - 400, 4 + 300, 0}, {4, -3, 0}}, Sphere{{0, 0, 0}, 5}, hit).yes());
  EXPECT_LE(std::abs(hit.distance_m - 500), hit.distance_error_m);
  EXPECT_FALSE(cast_ray({{3 - 400, 4 + 300, 0}, {4, -3, 0}}, Sphere{{0, 0, 0}, down(5.0)}, hit).yes());
  // A ray that ends at the touching point, and one that ends a step before.
  EXPECT_TRUE(cast_ray({{3 - 400, 4 + 300, 0}, {4, -3, 0}, 500}, Sphere{{0, 0, 0}, 5}, hit).yes());
  EXPECT_FALSE(cast_ray({{3 - 400, 4 + 300, 0}, {4, -3, 0}, down(500.0)}, Sphere{{0, 0, 0}, 5}, hit).yes());
}

TEST(ExtremeRayTangent, ABallOfNoSizeIsAPoint) {
  RayHit hit;
  EXPECT_TRUE(cast_ray({{0, 0, 0}, {1, 2, 3}}, Sphere{{2, 4, 6}, 0}, hit).yes());
  EXPECT_FALSE(cast_ray({{0, 0, 0}, {1, 2, 3}}, Sphere{{2, 4, up(6.0)}, 0}, hit).yes());
  EXPECT_TRUE(cast_ray({{0, 0, 0}, {1, 2, 3}}, Capsule{{2, 4, 6}, {2, 4, 7}, 0}, hit).yes());
  EXPECT_FALSE(cast_ray({{0, 0, 0}, {1, 2, 3}}, Capsule{{2, 4, up(6.0)}, {2, 4, 7}, 0}, hit).yes());
}

}  // namespace
}  // namespace collided::engine::tangent_test
