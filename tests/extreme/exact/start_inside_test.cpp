// A ray that starts within a solid has its entry behind it: the first root is negative, and the second is the exit, not
// the hit.
#include <gtest/gtest.h>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::start_inside_test {
namespace {

template <class Shape>
void expect_inside(const Ray& ray, const Shape& shape, double exit_m) {
  RayHit hit;
  ASSERT_TRUE(cast_ray(ray, shape, hit).yes());
  EXPECT_TRUE(hit.inside);
  EXPECT_EQ(hit.distance_m, 0);
  EXPECT_NEAR(hit.exit_m, exit_m, 4e-16 * exit_m);
}

const Sphere kBall{{0, 0, 0}, 5};
const Box kBox{.center = {0, 0, 0}, .half_m = {5, 6, 7}};
const Capsule kCapsule{{0, 0, -2}, {0, 0, 2}, 5};

TEST(ExtremeStartInside, TheHitIsAtZeroAndTheExitAhead) {
  expect_inside({{0, 0, 0}, {1, 0, 0}}, kBall, 5);
  expect_inside({{-3, 4, 0}, {1, 0, 0}}, kBall, 6);
  expect_inside({{0, 0, 0}, {0, 2, 0}}, kBox, 6);
  expect_inside({{-4, 0, 0}, {1, 0, 0}}, kBox, 9);
  expect_inside({{0, 0, 0}, {0, 0, 1}}, kCapsule, 7);
  expect_inside({{0, 0, 0}, {1, 0, 0}}, kCapsule, 5);
}

TEST(ExtremeStartInside, ALengthOfZeroIsEnough) {
  expect_inside({{0, 0, 0}, {1, 0, 0}, 0}, kBall, 5);
  expect_inside({{0, 0, 0}, {1, 0, 0}, 0x1p-1074}, kBox, 5);
  expect_inside({{0, 0, 0}, {1, 0, 0}, 0}, kCapsule, 5);
}

// Exactly on the surface and one step to either side: outward, inward and along.
TEST(ExtremeStartInside, OnTheSurfaceEveryDirectionHitsAtZero) {
  RayHit hit;
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(4, -3, 0)}) {
    for (const Vec3& start : {Vec3(5, 0, 0), Vec3(3, 4, 0)}) {
      ASSERT_TRUE(cast_ray({start, direction}, kBall, hit).yes());
      EXPECT_EQ(hit.distance_m, 0);
      ASSERT_TRUE(cast_ray({start, direction}, kCapsule, hit).yes());
      EXPECT_EQ(hit.distance_m, 0);
    }
    ASSERT_TRUE(cast_ray({{5, 6, 7}, direction}, kBox, hit).yes()) << "a corner";
    EXPECT_EQ(hit.distance_m, 0);
  }
  EXPECT_FALSE(cast_ray({{extreme::up(5), 0, 0}, {1, 0, 0}}, kBall, hit).yes());
  EXPECT_FALSE(cast_ray({{extreme::up(5), 0, 0}, {1, 0, 0}}, kBox, hit).yes());
  EXPECT_FALSE(cast_ray({{extreme::up(5), 0, 0}, {0, 1, 0}}, kCapsule, hit).yes());
  ASSERT_TRUE(cast_ray({{extreme::up(5), 0, 0}, {-1, 0, 0}}, kBall, hit).yes());
  EXPECT_EQ(hit.distance_m, extreme::up(5) - 5);
}

}  // namespace
}  // namespace collided::engine::start_inside_test
