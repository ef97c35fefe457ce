// Two surfaces a rounding apart, or the same surface a thousand times: which one is met first must not depend on luck.
#include <gtest/gtest.h>

#include <random>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"
#include "tests/oracle/seed.hpp"

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

Vec3 whole_numbers(std::mt19937_64& random) {
  const auto number = [&] { return static_cast<double>(random() % 9) - 4; };
  const double x = number();
  const double y = number();
  return {x, y, number()};
}

/// A triangle in the plane across the axis, some without area, with the point in its middle.
Triangle wall_about(const Vec3& middle, int axis, std::mt19937_64& random) {
  Vec3 u = whole_numbers(random);
  Vec3 v = whole_numbers(random);
  u[axis] = v[axis] = 0;
  return {middle + u, middle + v, middle - u - v};
}

/// The axis leans, exactly: planes across it are askew from then on, and parameters along rays stay.
Vec3 leaning(Vec3 v, int axis) {
  v[axis] += v[(axis + 1) % 3] + 2 * v[(axis + 2) % 3];
  return v;
}
Triangle leaning(const Triangle& t, int axis) { return {leaning(t.a, axis), leaning(t.b, axis), leaning(t.c, axis)}; }

// In one plane across an axis all are met at once, without arithmetic; leaning, expansions say so. A ray within the plane
// meets them one after the other.
TEST(ExtremeTwoSheets, WallsAcrossAnAxisAreOrderedAsLeaningOnes) {
  std::mt19937_64 random = oracle::seeded(20261129);
  std::size_t ties = 0;
  std::size_t within = 0;
  for (int i = 0; i < 3000; ++i) {
    const int axis = static_cast<int>(random() % 3);
    const Vec3 origin = whole_numbers(random);
    const Vec3 direction = whole_numbers(random);
    if (direction.isZero(0)) continue;
    const double far = random() % 2 == 0 ? 1 : 2;
    const Triangle a = wall_about(origin + direction, axis, random);
    const Triangle b = wall_about(origin + far * direction, axis, random);
    const Ray ray{origin, direction};
    const Ray lean{leaning(origin, axis), leaning(direction, axis)};
    RayHit hit;
    ASSERT_TRUE(cast_ray(ray, a, hit).yes() && cast_ray(ray, b, hit).yes()) << i;
    const int order = compare_hits(ray, a, b);
    EXPECT_EQ(order, compare_hits(lean, leaning(a, axis), leaning(b, axis))) << i;
    EXPECT_EQ(order, -compare_hits(ray, b, a)) << i;
    within += direction[axis] == 0 ? 1 : 0;
    if (direction[axis] == 0) continue;
    EXPECT_EQ(order, far == 1 ? 0 : -1) << i;
    ties += order == 0 ? 1 : 0;
  }
  EXPECT_GT(ties, 1000U);
  EXPECT_GT(within, 200U);
}

}  // namespace
}  // namespace collided::engine::two_sheets_test
