// Two surfaces a rounding apart, or the same surface a thousand times: which one is met first must not depend on luck.
#include <gtest/gtest.h>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::two_sheets_test {
namespace {

Triangle sheet(double z) { return {{0, 0, z}, {2, 0, z}, {0, 2, z}}; }

TEST(ExtremeTwoSheets, OneStepApartAreInOrder) {
  const Ray down{{0.25, 0.25, 2}, {0, 0, -1}};
  const Triangle low = sheet(1);
  const Triangle high = sheet(extreme::up(1));
  RayHit hit;
  ASSERT_TRUE(cast_ray(down, high, hit).yes());
  EXPECT_EQ(hit.distance_m, 1 - 0x1p-52);
  EXPECT_EQ(compare_hits(down, low, high), 1);
  EXPECT_EQ(compare_hits(down, high, low), -1);
  EXPECT_EQ(compare_hits(down, high, high), 0);
}

// Distances 2^-60 of a metre apart at a slant: both round to the same double.
TEST(ExtremeTwoSheets, TheOrderIsKnownWhereTheDistancesRoundToOne) {
  const Ray slanted{{0.25, 0.25, 1}, {0.125, 0.0625, -1}};
  const Triangle low = sheet(0);
  const Triangle high = sheet(0x1p-60);
  RayHit to_low, to_high;
  ASSERT_TRUE(cast_ray(slanted, low, to_low).yes());
  ASSERT_TRUE(cast_ray(slanted, high, to_high).yes());
  EXPECT_EQ(to_low.distance_m, to_high.distance_m);
  EXPECT_EQ(compare_hits(slanted, high, low), -1);
  EXPECT_EQ(compare_hits(slanted, low, high), 1);
}

// Two planes that cross exactly on the ray meet it at once, however they are tilted.
TEST(ExtremeTwoSheets, SheetsThatCrossOnTheRayAreEqual) {
  const Ray down{{0.25, 0.25, 3}, {0, 0, -1}};
  const Triangle flat = sheet(1);
  const Triangle tilted{{0, 0, 0.75}, {2, 0, 2.75}, {0, 2, 0.75}};  // z = 0.75 + x
  EXPECT_EQ(compare_hits(down, flat, tilted), 0);
  const Triangle steeper{{0, 0, extreme::up(0.75)}, {2, 0, 2.75}, {0, 2, 0.75}};
  EXPECT_EQ(compare_hits(down, flat, steeper), 1);
}

TEST(ExtremeTwoSheets, ScaleAndOffsetDoNotMatter) {
  const Ray slanted{{0.25, 0.25, 1}, {0.125, 0.0625, -1}};
  for (const int power : {-800, -300, 300, 800}) {
    const extreme::Scaling scale{power};
    EXPECT_EQ(compare_hits(scale(slanted), scale(sheet(0x1p-60)), scale(sheet(0))), -1) << power;
  }
}

}  // namespace
}  // namespace collided::engine::two_sheets_test
