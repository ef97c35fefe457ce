#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/ball_filter.hpp"
#include "server/exact_phase/overlap.hpp"
#include "tests/oracle/seed.hpp"

namespace collided {
namespace {

Vec3 any(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return {x, y, coordinate(random)};
}

MovingSphere resting(const Sphere& ball) { return {.start = ball.center, .end = ball.center, .radius_m = ball.radius_m}; }

// Within a rounding or two of touching, at rest and at the end of a way, on every scale.
TEST(BallFilter, NeverPartsWhatMeets) {
  std::mt19937_64 random = oracle::seeded(71);
  std::uniform_real_distribution<double> radius(0.1, 2);
  int touching = 0;
  for (int i = 0; i < 200'000; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(random() % 900) - 450);
    Sphere a{.center = any(random), .radius_m = radius(random)};
    Sphere b{.center = a.center, .radius_m = radius(random)};
    b.center += (a.radius_m + b.radius_m) * any(random).normalized();
    for (Sphere* ball : {&a, &b}) {
      ball->center *= scale;
      ball->radius_m *= scale;
    }
    if (!overlaps(a, b).yes()) continue;
    ++touching;
    ASSERT_FALSE(kernel::surely_apart(resting(a), b));
    const Vec3 from = a.center + 3 * (a.center - b.center);
    ASSERT_FALSE(kernel::surely_apart({.start = from, .end = a.center, .radius_m = a.radius_m}, b));
  }
  EXPECT_GT(touching, 50'000) << "the scenes must be worth testing";
}

// Centre on the way, grazing: the nearest point is inside the way.
TEST(BallFilter, SeesWhatPassesOnTheWay) {
  const Sphere other{.center = {0, 2, 0}, .radius_m = 1};
  EXPECT_FALSE(kernel::surely_apart({.start = {-9, 0, 0}, .end = {7, 0, 0}, .radius_m = 1}, other));
  EXPECT_TRUE(kernel::surely_apart({.start = {-9, 0, 0}, .end = {7, 0, 0}, .radius_m = 1 - 0x1p-20}, other));
  EXPECT_FALSE(kernel::surely_apart({.start = {-9, 4, 0}, .end = {7, 0, 0}, .radius_m = 1}, other));
}

TEST(BallFilter, SaysNothingOutOfRange) {
  const Sphere far{.center = {1e200, 0, 0}, .radius_m = 1};
  EXPECT_FALSE(kernel::surely_apart(resting({.center = Vec3::Zero(), .radius_m = 1}), far));
  const Sphere tiny{.center = {1e-170, 0, 0}, .radius_m = 0};
  EXPECT_FALSE(kernel::surely_apart(resting({.center = Vec3::Zero(), .radius_m = 0}), tiny));
}

}  // namespace
}  // namespace collided
