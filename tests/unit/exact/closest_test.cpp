#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/distance/closest.hpp"

namespace collided::engine::closest_test {
namespace {

const Box kUnitBox{{0, 0, 0}, Mat3::Identity(), {1, 1, 1}};
const Triangle kFloor{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

TEST(ExactClosest, FaceEdgeAndCornerOfABox) {
  EXPECT_EQ(closest(Vec3(3, 0.5, 0), kUnitBox).distance_m, 2);
  EXPECT_EQ(closest(Vec3(3, 0.5, 0), kUnitBox).point, Vec3(1, 0.5, 0));
  EXPECT_EQ(closest(Vec3(4, 5, 0), kUnitBox).distance_m, 5);  // 3-4-5
  EXPECT_EQ(closest(Vec3(4, 5, 0), kUnitBox).point, Vec3(1, 1, 0));
  EXPECT_EQ(closest(Vec3(2, 3, 3), kUnitBox).distance_m, 3);  // 1-2-2
}

TEST(ExactClosest, InsideASolidTheDistanceIsZeroAndTheNormalIsOfTheNearestFace) {
  const Closest inside = closest(Vec3(0, -0.75, 0.5), kUnitBox);
  EXPECT_EQ(inside.distance_m, 0);
  EXPECT_EQ(inside.normal, Vec3(0, -1, 0));
  EXPECT_EQ(closest(Vec3(0, 0, 0), Sphere{{0, 0, 0}, 1}).normal, Vec3(1, 0, 0));
  EXPECT_NEAR(closest(Vec3(0, 0, 1), Capsule{{0, 0, 0}, {0, 0, 2}, 1}).normal[2], 0, 1e-15);
}

TEST(ExactClosest, FaceEdgeAndCornerOfATriangle) {
  EXPECT_EQ(closest(Vec3(1, 1, -3), kFloor).distance_m, 3);
  EXPECT_EQ(closest(Vec3(1, 1, -3), kFloor).normal, Vec3(0, 0, -1));
  EXPECT_EQ(closest(Vec3(1, -3, 4), kFloor).distance_m, 5);
  EXPECT_EQ(closest(Vec3(1, -3, 4), kFloor).point, Vec3(1, 0, 0));
  EXPECT_EQ(closest(Vec3(-1, -2, 2), kFloor).distance_m, 3);
  EXPECT_EQ(closest(Vec3(1, 1, 0), kFloor).distance_m, 0);
  EXPECT_EQ(std::abs(closest(Vec3(1, 1, 0), kFloor).normal[2]), 1);
}

TEST(ExactClosest, TouchingIsExactlyZero) {
  EXPECT_EQ(closest(Vec3(3, 4, 0), Sphere{{0, 0, 0}, 5}).distance_m, 0);
  EXPECT_EQ(closest(Vec3(3, 4, 0), Sphere{{0, 0, 0}, 5}).distance_error_m, 0);
  EXPECT_EQ(closest(Vec3(1, 0.3, 0.7), kUnitBox).distance_m, 0);
}

// One step of the last digit above the surface: the absolute error of double is as large as the distance itself.
TEST(ExactClosest, RelativeErrorStaysSmallAtTheSurface) {
  const double ulp = 0x1p-52;
  const Closest above_sphere = closest(Vec3(3, 4 + 4 * ulp, 0), Sphere{{0, 0, 0}, 5});
  EXPECT_NEAR(above_sphere.distance_m / (3.2 * ulp), 1, 1e-12);
  EXPECT_LE(above_sphere.distance_error_m, 1e-12 * above_sphere.distance_m);
  const Triangle tilted{{0, 0, 0}, {3, 0, 1}, {0, 3, 1}};
  const Closest above_triangle = closest(Vec3(1, 1, 2.0 / 3), tilted);
  EXPECT_GT(above_triangle.distance_m, 0);
  EXPECT_LE(above_triangle.distance_error_m, 1e-12 * above_triangle.distance_m);
  const Closest above_box = closest(Vec3(1 + ulp, 0.1, 0.2), kUnitBox);
  EXPECT_EQ(above_box.distance_m, ulp);
}

TEST(ExactClosest, DegenerateShapesAreSegmentsAndPoints) {
  EXPECT_EQ(closest(Vec3(0, 3, 4), Triangle{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}).distance_m, 5);
  EXPECT_EQ(closest(Vec3(3, 4, 0), Triangle{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}).distance_m, 5);
  EXPECT_EQ(closest(Vec3(3, 4, 0), Capsule{{0, 0, 0}, {0, 0, 0}, 2}).distance_m, 3);
  EXPECT_EQ(closest(Vec3(3, 4, 0), Box{{0, 0, 0}, Mat3::Identity(), {0, 0, 0}}).distance_m, 5);
}

}  // namespace
}  // namespace collided::engine::closest_test
