// A ball that crosses a millimetre within a microsecond of a one-second step: the root lies between two samples of any
// sensible step, and at speeds of 2^200 beside every rounding of the end points.
#include <gtest/gtest.h>

#include "server/exact_phase/motion/time_of_contact.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::wall_in_time_test {
namespace {

constexpr double kHalfWall = 0x1p-11;
constexpr double kRadius = 0x1p-7;

template <class Wall>
void expect_at(const MovingSphere& mover, const Wall& wall, double time) {
  TimeBracket bracket;
  ASSERT_TRUE(first_contact(mover, wall, 1e-12, bracket).yes());
  EXPECT_LE(bracket.low, time);
  EXPECT_GE(bracket.high, time);
  EXPECT_LE(bracket.high - bracket.low, 1e-12);
}

TEST(ExtremeWallInTime, AKilometreASecondThroughAMillimetre) {
  const MovingSphere bullet{{-512, 0.25, 0.125}, {512, 0.25, 0.125}, kRadius};
  const double time = (512 - kHalfWall - kRadius) / 1024;
  expect_at(bullet, Box{.center = {0, 0, 0}, .half_m = {kHalfWall, 1, 1}}, time);
  expect_at(bullet, Triangle{{-kHalfWall, -4, -4}, {-kHalfWall, 4, -4}, {-kHalfWall, 0, 4}}, time);
  expect_at(bullet, Capsule{{0, 0.25, -1}, {0, 0.25, 1}, kHalfWall}, time);
}

TEST(ExtremeWallInTime, EverySpeedUpToTheEndOfTheRange) {
  for (int power = 0; power <= 1000; power += 50) {
    const double reach = std::ldexp(1.0, power);
    expect_at({{-reach, 0, 0}, {reach, 0, 0}, 0}, Box{.center = {0, 0, 0}, .half_m = {0, 1, 1}}, 0.5);
    expect_at({{-reach, 0, 0}, {reach, 0, 0}, 0}, Triangle{{0, -4, -4}, {0, 4, -4}, {0, 0, 4}}, 0.5);
  }
}

TEST(ExtremeWallInTime, OutAndInAgainTheFirstCounts) {
  // Through a hollow of two walls: the first is met, whichever comes first in the list.
  TimeBracket first, second;
  const MovingSphere bullet{{-8, 0, 0}, {8, 0, 0}, 0};
  ASSERT_TRUE(first_contact(bullet, Box{.center = {-4, 0, 0}, .half_m = {0, 1, 1}}, 1e-12, first).yes());
  ASSERT_TRUE(first_contact(bullet, Box{.center = {4, 0, 0}, .half_m = {0, 1, 1}}, 1e-12, second).yes());
  EXPECT_LE(first.low, 0.25);
  EXPECT_LE(first.high, second.low);
  // From inside to outside: in contact from the start.
  TimeBracket inside{1, 1};
  ASSERT_TRUE(first_contact(bullet, Sphere{{-8, 0, 0}, 1}, 1e-12, inside).yes());
  EXPECT_EQ(inside.high, 0);
}

TEST(ExtremeWallInTime, TheEndOfTheStepBelongsToIt) {
  TimeBracket bracket;
  const Box wall{.center = {1, 0, 0}, .half_m = {0.5, 1, 1}};
  ASSERT_TRUE(first_contact({{-9, 0, 0}, {0, 0, 0}, 0.5}, wall, 1e-12, bracket).yes()) << "touching at 1 exactly";
  EXPECT_EQ(bracket.high, 1);
  EXPECT_FALSE(first_contact({{-9, 0, 0}, {0, 0, 0}, extreme::down(0.5)}, wall, 1e-12, bracket).yes());
  EXPECT_FALSE(first_contact({{-9, 0, 0}, {-0x1p-1074, 0, 0}, 0.5}, wall, 1e-12, bracket).yes());
}

TEST(ExtremeWallInTime, MotionsTooSmallToMatter) {
  TimeBracket bracket;
  const Box wall{.center = {1, 0, 0}, .half_m = {0.5, 1, 1}};
  EXPECT_FALSE(first_contact({{-1, 0, 0}, {-1 + 0x1p-53, 0, 0}, 0.5}, wall, 1e-12, bracket).yes());
  expect_at({{-0x1p-1000, 0, 0}, {0x1p-1000, 0, 0}, 0.5}, wall, 0.5);
}

}  // namespace
}  // namespace collided::engine::wall_in_time_test
