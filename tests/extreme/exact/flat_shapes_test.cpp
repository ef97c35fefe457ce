#include <gtest/gtest.h>

#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::flat_shapes_test {
namespace {

using extreme::down;
using extreme::up;

const Box kPlate{{0, 0, 0}, Mat3::Identity(), {2, 2, 0}};
const Box kRod{{0, 0, 0}, Mat3::Identity(), {2, 0, 0}};
const Box kDot{{1, 1, 0}, Mat3::Identity(), {0, 0, 0}};

TEST(ExtremeFlatShapes, PlatesRodsAndDotsMeet) {
  EXPECT_TRUE(overlaps(kPlate, kPlate).yes());
  EXPECT_TRUE(overlaps(kPlate, kRod).yes());
  EXPECT_TRUE(overlaps(kPlate, kDot).yes());
  EXPECT_TRUE(overlaps(kDot, kDot).yes());
  EXPECT_FALSE(overlaps(kRod, kDot).yes());
  EXPECT_FALSE(overlaps(kPlate, Box{{1, 1, up(0.0)}, Mat3::Identity(), {0, 0, 0}}).yes());
  EXPECT_FALSE(overlaps(kPlate, Box{{5, 0, 0}, Mat3::Identity(), {2, 2, 0}}).yes());
  EXPECT_TRUE(overlaps(kPlate, Box{{4, 0, 0}, Mat3::Identity(), {2, 2, 0}}).yes());
}

TEST(ExtremeFlatShapes, AgainstBallsAndTriangles) {
  EXPECT_TRUE(overlaps(Sphere{{0, 0, 1}, 1}, kPlate).yes());
  EXPECT_FALSE(overlaps(Sphere{{0, 0, 1}, down(1.0)}, kPlate).yes());
  EXPECT_TRUE(overlaps(Sphere{{0, 3, 4}, 5}, kRod).yes());
  EXPECT_FALSE(overlaps(Sphere{{0, 3, 4}, down(5.0)}, kRod).yes());
  EXPECT_TRUE(overlaps(kPlate, Triangle{{1, 1, 0}, {1, 1, 3}, {1, 2, 3}}).yes());
  EXPECT_FALSE(overlaps(kPlate, Triangle{{1, 1, up(0.0)}, {1, 1, 3}, {1, 2, 3}}).yes());
  EXPECT_TRUE(overlaps(kRod, Triangle{{1, -1, -1}, {1, 1, -1}, {1, 0, 1}}).yes());
  EXPECT_FALSE(overlaps(kRod, Triangle{{up(2.0), -1, -1}, {3, 1, -1}, {3, 0, 1}}).yes());
}

TEST(ExtremeFlatShapes, RaysMeetThem) {
  RayHit hit;
  EXPECT_TRUE(cast_ray({{1, 1, 3}, {0, 0, -1}}, kPlate, hit).yes());
  EXPECT_EQ(hit.distance_m, 3);
  EXPECT_EQ(hit.exit_m, 3);
  EXPECT_TRUE(cast_ray({{1, 0, 3}, {0, 0, -1}}, kRod, hit).yes());
  EXPECT_FALSE(cast_ray({{1, up(0.0), 3}, {0, 0, -1}}, kRod, hit).yes());
  EXPECT_TRUE(cast_ray({{1, 1, 3}, {0, 0, -1}}, kDot, hit).yes());
  EXPECT_TRUE(cast_ray({{-5, 1, 0}, {1, 0, 0}}, kPlate, hit).yes()) << "edge on";
  EXPECT_EQ(hit.distance_m, 3);
}

}  // namespace
}  // namespace collided::engine::flat_shapes_test
