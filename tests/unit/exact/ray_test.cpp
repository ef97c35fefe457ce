#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"

namespace collided::engine::ray_test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
const Triangle kFloor{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

Ray down(double x, double y, double length_m = kInf) { return {{x, y, 1}, {0, 0, -1}, length_m}; }

TEST(ExactRayTriangle, InsideBorderAndOutside) {
  RayHit hit;
  EXPECT_TRUE(cast_ray(down(1, 1), kFloor, hit).yes());
  EXPECT_EQ(hit.distance_m, 1);
  EXPECT_EQ(hit.normal, Vec3(0, 0, 1));
  EXPECT_EQ(hit.point, Vec3(1, 1, 0));
  EXPECT_TRUE(hit.weights.isApprox(Vec3(0.5, 0.25, 0.25)));
  for (const Vec3& corner : {kFloor.a, kFloor.b, kFloor.c})
    EXPECT_TRUE(cast_ray(down(corner[0], corner[1]), kFloor, hit).yes());
  EXPECT_TRUE(cast_ray(down(2, 2), kFloor, hit).yes());
  EXPECT_FALSE(cast_ray(down(2, std::nextafter(2.0, 3.0)), kFloor, hit).yes());
  EXPECT_FALSE(cast_ray(down(-std::numeric_limits<double>::denorm_min(), 0), kFloor, hit).yes());
}

TEST(ExactRayTriangle, BothSidesAndBothEndsCount) {
  RayHit hit;
  EXPECT_TRUE(cast_ray({{1, 1, -1}, {0, 0, 3}}, kFloor, hit).yes());
  EXPECT_EQ(hit.distance_m, 1);
  EXPECT_EQ(hit.normal, Vec3(0, 0, -1));
  EXPECT_TRUE(cast_ray({{1, 1, 0}, {0, 0, 3}}, kFloor, hit).yes());
  EXPECT_EQ(hit.distance_m, 0);
  EXPECT_TRUE(cast_ray(down(1, 1, 1), kFloor, hit).yes());
  EXPECT_FALSE(cast_ray(down(1, 1, std::nextafter(1.0, 0.0)), kFloor, hit).yes());
  EXPECT_FALSE(cast_ray({{1, 1, 1}, {0, 0, 1}}, kFloor, hit).yes());
}

// 3-4-5: the length is metres along a direction that is not a unit vector.
TEST(ExactRayTriangle, TheLengthIsMetres) {
  RayHit hit;
  EXPECT_TRUE(cast_ray({{-3, 1, 4}, {6, 0, -8}, 5}, kFloor, hit).yes());
  EXPECT_EQ(hit.distance_m, 5);
  EXPECT_FALSE(cast_ray({{-3, 1, 4}, {6, 0, -8}, std::nextafter(5.0, 0.0)}, kFloor, hit).yes());
}

TEST(ExactRayTriangle, InThePlaneTheBorderIsMetFirst) {
  RayHit hit;
  EXPECT_TRUE(cast_ray({{-1, 1, 0}, {1, 0, 0}}, kFloor, hit).yes());
  EXPECT_EQ(hit.distance_m, 1);
  EXPECT_TRUE(cast_ray({{1, 1, 0}, {1, 0, 0}}, kFloor, hit).yes());
  EXPECT_EQ(hit.distance_m, 0);
  EXPECT_TRUE(cast_ray({{-1, 0, 0}, {1, 0, 0}}, kFloor, hit).yes());
  EXPECT_EQ(hit.distance_m, 1);
  EXPECT_TRUE(cast_ray({{8, -4, 0}, {-1, 1, 0}}, kFloor, hit).yes());  // along the long side
  EXPECT_NEAR(hit.distance_m, 4 * std::sqrt(2.0), 1e-15 * 8);
  EXPECT_FALSE(cast_ray({{-1, 5, 0}, {1, 0, 0}}, kFloor, hit).yes());
  EXPECT_FALSE(cast_ray({{-1, 1, 1e-300}, {1, 0, 0}}, kFloor, hit).yes());
}

// A36
TEST(ExactRayTriangle, WeightsSumToOneAndPlaceThePoint) {
  const Triangle t{{0.1, 0.2, 0.3}, {4.7, -0.3, 0.9}, {-0.4, 3.9, -1.1}};
  for (const double s : {0.1, 0.3, 0.7}) {
    const Vec3 target = 0.2 * t.a + 0.8 * (s * t.b + (1 - s) * t.c);
    RayHit hit;
    ASSERT_TRUE(cast_ray({{1, 2, 5}, target - Vec3(1, 2, 5)}, t, hit).yes());
    EXPECT_NEAR(hit.weights.sum(), 1, 0x1p-52);
    EXPECT_TRUE(hit.weights.isApprox(Vec3(0.2, 0.8 * s, 0.8 * (1 - s)), 1e-13));
    EXPECT_TRUE(hit.point.isApprox(target, 1e-14));
  }
  RayHit corner;
  ASSERT_TRUE(cast_ray({t.b, {1, 1, 1}}, t, corner).yes());
  EXPECT_EQ(corner.weights, Vec3(0, 1, 0));
  EXPECT_EQ(corner.distance_m, 0);
}

TEST(ExactRayTriangle, AFlatTriangleIsItsSegmentOrPoint) {
  RayHit hit;
  const Triangle segment{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}};
  EXPECT_TRUE(cast_ray(down(2, 0), segment, hit).yes());
  EXPECT_EQ(hit.distance_m, 1);
  EXPECT_NEAR(hit.normal.norm(), 1, 1e-15);
  EXPECT_FALSE(cast_ray(down(3.5, 0), segment, hit).yes());
  EXPECT_TRUE(cast_ray({{-2, 0, 0}, {1, 0, 0}}, segment, hit).yes());
  EXPECT_EQ(hit.distance_m, 2);
  const Triangle point{{1, 1, 0}, {1, 1, 0}, {1, 1, 0}};
  EXPECT_TRUE(cast_ray(down(1, 1), point, hit).yes());
  EXPECT_EQ(hit.distance_m, 1);
  EXPECT_FALSE(cast_ray(down(1, 1 + 1e-15), point, hit).yes());
}

TEST(ExactRaySphere, EnterLeaveTouchAndInside) {
  RayHit hit;
  const Sphere unit{{0, 0, 0}, 1};
  EXPECT_TRUE(cast_ray({{-3, 0, 0}, {2, 0, 0}}, unit, hit).yes());
  EXPECT_EQ(hit.distance_m, 2);
  EXPECT_EQ(hit.exit_m, 4);
  EXPECT_EQ(hit.normal, Vec3(-1, 0, 0));
  EXPECT_TRUE(cast_ray({{-1e8, 1, 0}, {1, 0, 0}}, unit, hit).yes());
  EXPECT_EQ(hit.distance_m, 1e8);
  EXPECT_FALSE(cast_ray({{-1e8, 1 + 0x1p-52, 0}, {1, 0, 0}}, unit, hit).yes());
  EXPECT_TRUE(cast_ray({{0.5, 0, 0}, {1, 0, 0}}, unit, hit).yes());
  EXPECT_TRUE(hit.inside);
  EXPECT_EQ(hit.distance_m, 0);
  EXPECT_EQ(hit.exit_m, 0.5);
  EXPECT_TRUE(cast_ray({{-3, 0, 0}, {2, 0, 0}, 2}, unit, hit).yes());
  EXPECT_FALSE(cast_ray({{-3, 0, 0}, {2, 0, 0}, std::nextafter(2.0, 0.0)}, unit, hit).yes());
  EXPECT_FALSE(cast_ray({{3, 0, 0}, {2, 0, 0}}, unit, hit).yes());
}

TEST(ExactRayBox, EnterLeaveTouchAndInside) {
  RayHit hit;
  const Box box{{0, 0, 0}, Mat3::Identity(), {1, 2, 3}};
  EXPECT_TRUE(cast_ray({{-3, 0, 0}, {2, 0, 0}}, box, hit).yes());
  EXPECT_EQ(hit.distance_m, 2);
  EXPECT_EQ(hit.exit_m, 4);
  EXPECT_EQ(hit.normal, Vec3(-1, 0, 0));
  EXPECT_TRUE(cast_ray({{-3, 2, -0.0}, {2, 0, -0.0}}, box, hit).yes());  // in a face plane
  EXPECT_FALSE(cast_ray({{-3, 2 + 0x1p-51, 0}, {2, 0, 0}}, box, hit).yes());
  EXPECT_TRUE(cast_ray({{0, 1, 0}, {0, 1, 0}}, box, hit).yes());
  EXPECT_TRUE(hit.inside);
  EXPECT_EQ(hit.exit_m, 1);
  EXPECT_EQ(hit.normal, Vec3(0, 1, 0));
  EXPECT_TRUE(cast_ray({{-3, 0, 0}, {2, 0, 0}, 2}, box, hit).yes());
  EXPECT_FALSE(cast_ray({{-3, 0, 0}, {2, 0, 0}, std::nextafter(2.0, 0.0)}, box, hit).yes());
}

TEST(ExactRayCapsule, WallEndsAndInside) {
  RayHit hit;
  const Capsule pill{{0, 0, -2}, {0, 0, 2}, 1};
  EXPECT_TRUE(cast_ray({{-3, 0, 0}, {1, 0, 0}}, pill, hit).yes());
  EXPECT_EQ(hit.distance_m, 2);
  EXPECT_EQ(hit.exit_m, 4);
  EXPECT_EQ(hit.normal, Vec3(-1, 0, 0));
  EXPECT_TRUE(cast_ray({{0, 0, -5}, {0, 0, 2}}, pill, hit).yes());
  EXPECT_EQ(hit.distance_m, 2);
  EXPECT_EQ(hit.exit_m, 8);
  EXPECT_TRUE(cast_ray({{-3, 1, 2}, {1, 0, 0}}, pill, hit).yes());  // tangent where wall and end meet
  EXPECT_EQ(hit.distance_m, 3);
  EXPECT_FALSE(cast_ray({{-3, 1, 2 + 1e-9}, {1, 0, 0}}, pill, hit).yes());
  EXPECT_TRUE(cast_ray({{0.5, 0, 0}, {1, 0, 0}}, pill, hit).yes());
  EXPECT_TRUE(hit.inside);
  EXPECT_EQ(hit.exit_m, 0.5);
  EXPECT_FALSE(cast_ray({{-3, 0, 0}, {1, 0, 0}, std::nextafter(2.0, 0.0)}, pill, hit).yes());
}

// The census of how often double is not enough stands on this count.
TEST(ExactRay, OneThatDoubleCannotDecideIsCountedOnceAndAClearOneNever) {
  const Triangle triangle{{0.1, 0.1, 0}, {1.1, 0.1, 0}, {0.1, 1.1, 0}};
  const auto counted = [&](const Vec3& through) {
    const std::uint64_t before = kernel::rungs.uncertain;
    RayHit hit;
    EXPECT_TRUE(cast_ray(Ray{through + Vec3(0, 0, 1), Vec3(0, 0, -1)}, triangle, hit).yes());
    return kernel::rungs.uncertain - before;
  };
  EXPECT_EQ(counted({0.3, 0.3, 0}), 0u);
  EXPECT_EQ(counted({0.1, 0.1, 0}), 1u) << "through a corner";
  EXPECT_EQ(counted({0.6, 0.1, 0}), 1u) << "through an edge";
}

}  // namespace
}  // namespace collided::engine::ray_test
