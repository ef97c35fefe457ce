#include <gtest/gtest.h>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::ends_test {
namespace {

using extreme::down;
using extreme::up;

/// The direction (2, 3, 6) has length 7, so every end is exactly representable; its multiples are not unit vectors.
void expect_end_at_seven(const auto& shape) {
  for (const double stretch : {1.0, 3.0, 0x1p-40, 0x1p300}) {
    const Vec3 direction = stretch * Vec3(2, 3, 6);
    RayHit hit;
    EXPECT_TRUE(cast_ray(Ray{{0, 0, 0}, direction, 7}, shape, hit).yes()) << stretch;
    EXPECT_LE(std::abs(hit.distance_m - 7), hit.distance_error_m);
    EXPECT_TRUE(cast_ray(Ray{{0, 0, 0}, direction, up(7.0)}, shape, hit).yes()) << stretch;
    EXPECT_FALSE(cast_ray(Ray{{0, 0, 0}, direction, down(7.0)}, shape, hit).yes()) << stretch;
    EXPECT_FALSE(cast_ray(Ray{{0, 0, 0}, -direction, 7}, shape, hit).yes()) << stretch;
  }
}

// A19: both ends count, whatever the direction's length.
TEST(ExtremeRayEnds, TheLengthIsExactInEveryShape) {
  expect_end_at_seven(Triangle{{0, 0, 6}, {8, 0, 6}, {0, 8, 6}});
  expect_end_at_seven(Sphere{{4, 6, 12}, 7});
  expect_end_at_seven(Box{{2, 3, 8}, Mat3::Identity(), {5, 5, 2}});
  expect_end_at_seven(Capsule{{4, 6, 12}, {14, 16, 12}, 7});
}

TEST(ExtremeRayEnds, AStartOnTheSurfaceIsAHitAtZero) {
  RayHit hit;
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0)}) {
    for (const double length : {0.0, 1.0}) {
      const Ray ray{{1, 0, 0}, direction, length};
      EXPECT_TRUE(cast_ray(ray, Sphere{{0, 0, 0}, 1}, hit).yes());
      EXPECT_EQ(hit.distance_m, 0);
      EXPECT_TRUE(cast_ray(ray, Box{{0, 0, 0}, Mat3::Identity(), {1, 1, 1}}, hit).yes());
      EXPECT_EQ(hit.distance_m, 0);
      EXPECT_TRUE(cast_ray(ray, Capsule{{0, 0, -1}, {0, 0, 1}, 1}, hit).yes());
      EXPECT_EQ(hit.distance_m, 0);
      EXPECT_TRUE(cast_ray(ray, Triangle{{1, -1, -1}, {1, 1, -1}, {1, 0, 1}}, hit).yes());
      EXPECT_EQ(hit.distance_m, 0);
    }
  }
  EXPECT_FALSE(cast_ray({{up(1.0), 0, 0}, {1, 0, 0}}, Sphere{{0, 0, 0}, 1}, hit).yes());
}

}  // namespace
}  // namespace collided::engine::ends_test
