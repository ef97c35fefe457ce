// A common origin is subtracted without rounding, or not at all.
#include "server/geometry/common_origin.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/geometry/lost_in_sum.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
const double kNan = std::numeric_limits<double>::quiet_NaN();

bool is_exactly_seen(double x, double origin) { return lost_in_sum(x, -origin, x - origin) == 0; }

// Coordinates from equal to many orders apart, of both signs: what passes is never rounded, and an origin is taken wherever
// the other point is near.
TEST(GeometryCommonOrigin, WhatIsSeenFromItIsNotRounded) {
  std::mt19937_64 random = oracle::seeded(61);
  std::uniform_real_distribution<double> in(-1, 1);
  int taken = 0;
  for (int i = 0; i < 100'000; ++i) {
    const auto coordinate = [&] { return std::copysign(std::exp2(20 + 12 * in(random)), in(random)); };
    const Vec3 point(coordinate(), coordinate(), coordinate());
    const double apart = std::exp2(40 * in(random)-20);
    const Vec3 other = point + apart * point.cwiseAbs().maxCoeff() * Vec3(in(random), in(random), in(random));
    const Vec3 origin = common_origin(point, {other});
    for (int k = 0; k < 3; ++k) {
      const bool is_far = std::abs(point[k]) >= kFarOut_m;
      if (origin[k] == 0) {
        EXPECT_FALSE(is_far && std::abs(other[k] - point[k]) < std::abs(point[k]) / 4) << point[k] << ' ' << other[k];
        continue;
      }
      ++taken;
      EXPECT_TRUE(is_far) << point[k];
      EXPECT_LE(std::abs(point[k] - origin[k]), kOriginGrid_m / 2);
      EXPECT_TRUE(is_exactly_seen(point[k], origin[k])) << point[k] << ' ' << origin[k];
      EXPECT_TRUE(is_exactly_seen(other[k], origin[k])) << other[k] << ' ' << origin[k];
    }
  }
  EXPECT_GT(taken, 10'000);
}

struct Axis {
  double point;
  double other;
  double origin;  // expected
};

TEST(GeometryCommonOrigin, EachAxisIsTakenByItself) {
  constexpr double kFar = 0x1p30;
  const Axis cases[] = {
      {kFar + 1, kFar - 3, kFar},
      {-kFar, -kFar - 8, -kFar},
      {kFarOut_m, kFarOut_m, kFarOut_m},
      {std::nextafter(kFarOut_m, 0), kFarOut_m, 0},  // not far enough
      {kFar, 2 * kFar, kFar},
      {kFar, std::nextafter(2 * kFar, kInfinite), 0},  // more than twice as far
      {kFar, kFar / 2, kFar},
      {kFar, std::nextafter(kFar / 2, 0), 0},
      {kFar, -kFar, 0},
      {kFar, 0, 0},
      {kFar, kInfinite, 0},
      {kFar, kNan, 0},
      {kInfinite, kFar, 0},
      {kNan, kFar, 0},
  };
  for (const Axis& axis : cases) {
    for (int k = 0; k < 3; ++k) {
      Vec3 point(1, 2, 3);
      Vec3 other(4, 5, 6);
      point[k] = axis.point;
      other[k] = axis.other;
      Vec3 expected = Vec3::Zero();
      expected[k] = axis.origin;
      EXPECT_EQ(common_origin(point, {other}), expected) << axis.point << ' ' << axis.other << " on axis " << k;
    }
  }
}

// Near the world's origin nothing changes, to the last bit: not even the sign of a zero.
TEST(GeometryCommonOrigin, FromTheWorldsOriginEverythingKeepsItsBits) {
  const Vec3 none = common_origin({1000, -20, 3}, {{1001, -21, 3.5}});
  EXPECT_TRUE(none.isZero(0));
  const Vec3 point(-0.0, 0.1, -1e-300);
  EXPECT_TRUE(std::signbit(seen_from(none, point)[0]));
  EXPECT_TRUE(std::signbit(back_from(none, point)[0]));
  EXPECT_EQ(seen_from(none, point), point);
  const Aabb box{.low = {-0.1, 0.1, 1}, .high = {0.2, 0.3, kInfinite}};
  EXPECT_EQ(seen_from(none, box).low, box.low);
  EXPECT_EQ(seen_from(none, box).high, box.high);
}

// Bounds need not be near: they are rounded outward, endless sides stay endless, and an empty box stays empty.
TEST(GeometryCommonOrigin, BoundsSeenFromItHoldWhatTheyHeld) {
  const Vec3 origin(0x1p30, -0x1p29, 0);
  const Aabb box{.low = {0.1, -0x1p29 - 0.5, -kInfinite}, .high = {0x1p30 + 0.25, -0.1, kInfinite}};
  const Aabb seen = seen_from(origin, box);
  EXPECT_LT(seen.low[0], 0.1 - 0x1p30);
  EXPECT_GT(seen.high[0], 0.25);
  EXPECT_LT(seen.low[1], -0.5);
  EXPECT_GT(seen.high[1], -0.1 + 0x1p29);
  EXPECT_EQ(seen.low[2], -kInfinite);
  EXPECT_EQ(seen.high[2], kInfinite);
  EXPECT_TRUE(seen_from(origin, Aabb{}).empty());
}

}  // namespace
}  // namespace collided::engine
