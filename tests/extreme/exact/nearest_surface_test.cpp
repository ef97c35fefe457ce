#include <gtest/gtest.h>

#include "server/exact_phase/distance/closest.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::nearest_surface_test {
namespace {

// Ever nearer to a tilted triangle: the digits of the distance are not eaten by the coordinates.
TEST(ExtremeNearestSurface, EveryGapKeepsTwelveDigits) {
  const Triangle tilted{{0, 0, 0}, {7, 1, 2}, {-1, 5, 3}};
  const Vec3 inside = (tilted.a + tilted.b + tilted.c) / 4;
  const Vec3 normal = (tilted.b - tilted.a).cross(tilted.c - tilted.a).normalized();
  for (double gap = 1; gap > 1e-18; gap /= 8) {
    const Closest c = closest(inside + gap * normal, tilted);
    EXPECT_LE(c.distance_error_m, 1e-12 * c.distance_m) << gap;
    EXPECT_NEAR(c.distance_m, gap, 1e-15) << gap;
    EXPECT_NEAR(std::abs(c.normal.dot(normal)), 1, 1e-12) << gap;
  }
}

TEST(ExtremeNearestSurface, TinyAndHugeShapes) {
  for (int power = -1000; power <= 1000; power += 100) {
    const extreme::Scaling scale{power};
    const Vec3 p = scale(Vec3(3, 4, 0));
    EXPECT_EQ(closest(p, scale(Sphere{{0, 0, 0}, 2})).distance_m, scale(3.0)) << power;
    EXPECT_EQ(closest(p, scale(Capsule{{0, 0, -1}, {0, 0, 1}, 2})).distance_m, scale(3.0)) << power;
    EXPECT_EQ(closest(p, scale(Box{{0, 0, 0}, Mat3::Identity(), {0, 0, 9}})).distance_m, scale(5.0)) << power;
    const Closest c = closest(p, scale(Triangle{{0, 0, -1}, {0, 0, 1}, {-1, -1, 0}}));
    EXPECT_EQ(c.distance_m, scale(5.0)) << power;
    EXPECT_NEAR(c.normal.dot(Vec3(0.6, 0.8, 0)), 1, 1e-14) << power;
    EXPECT_EQ(c.point, Vec3(0, 0, 0)) << power;
  }
}

// On the border between two features both formulas hold; neither may be missed.
TEST(ExtremeNearestSurface, FeatureBordersAgree) {
  const Box box{{0, 0, 0}, Mat3::Identity(), {1, 1, 1}};
  EXPECT_EQ(closest(Vec3(4, 1, 0), box).distance_m, 3);
  EXPECT_EQ(closest(Vec3(4, 1, 1), box).distance_m, 3);
  const Triangle floor{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  EXPECT_EQ(closest(Vec3(4, -3, 4), floor).distance_m, 5);
  EXPECT_EQ(closest(Vec3(2, 2, 7), floor).distance_m, 7);
}

}  // namespace
}  // namespace collided::engine::nearest_surface_test
