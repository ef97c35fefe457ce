#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/motion/ground_motion.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::ground_motion_test {
namespace {

const HalfSpace kGround{.point = {3, -2, 0}, .normal = {0, 0, 2}};
constexpr double kWidth = 1e-9;

Frame at(const Vec3& position, double turn_rad = 0) {
  return {Eigen::AngleAxisd(turn_rad, Vec3::UnitY()).toRotationMatrix(), position};
}

TEST(GroundMotion, ABoxThatFallsTouchesWhereItsCornerDoes) {
  std::mt19937_64 random = oracle::seeded(81);
  std::uniform_real_distribution<double> part(0, 1);
  for (int i = 0; i < 200; ++i) {
    const double turn_rad = 6 * part(random);
    const Box box{.center = Vec3::Zero(), .half_m = {0.1 + part(random), 0.2, 0.1 + part(random)}};
    const double reach_m = box.half_m[0] * std::abs(std::sin(turn_rad)) + box.half_m[2] * std::abs(std::cos(turn_rad));
    const double high_m = reach_m + 0.1 + 5 * part(random);
    const double fall_m = 8 * part(random);
    const BodyMotion motion(at({1, 2, high_m}, turn_rad), at({-4, 5, high_m - fall_m}, turn_rad));
    TimeBracket bracket;
    const ExactResult verdict = first_contact(PartMotion(box, motion), kGround, {0, 1}, kWidth, bracket);
    const double expected = (high_m - reach_m) / fall_m;
    ASSERT_EQ(verdict.yes(), expected <= 1) << i;
    if (!verdict.yes()) continue;
    EXPECT_LE(bracket.low, expected + 1e-13) << i;
    EXPECT_GE(bracket.high, expected - 1e-13) << i;
    EXPECT_LE(bracket.high - bracket.low, kWidth) << i;
  }
}

// Level at both ends of the way, upright in the middle of it.
TEST(GroundMotion, ARodThatTurnsDipsInBetween) {
  const Capsule rod{.a = {-1, 0, 0}, .b = {1, 0, 0}, .radius_m = 0.05};
  const double turn_rad = 3;
  for (const double high_m : {0.06, 0.5, 1.0, 1.04, 1.06}) {
    const BodyMotion motion(at({0, 0, high_m}, 0), at({0, 0, high_m}, turn_rad));
    TimeBracket bracket;
    const ExactResult verdict = first_contact(PartMotion(rod, motion), kGround, {0, 1}, kWidth, bracket);
    ASSERT_EQ(verdict.yes(), high_m < 1.05) << high_m;
    if (!verdict.yes()) {
      EXPECT_EQ(verdict.decision, Decision::no) << high_m;
      continue;
    }
    const double expected = std::asin((high_m - 0.05) / 1) / turn_rad;
    EXPECT_NEAR(bracket.high, expected, 2e-9) << high_m;
    EXPECT_LE(bracket.low, expected + 1e-13) << high_m;
  }
}

TEST(GroundMotion, WhatLiesOnTheGroundTouchesAtOnce) {
  const BodyMotion motion(at({0, 0, 1}), at({0, 0, 9}));
  TimeBracket bracket{0.5, 0.5};
  EXPECT_TRUE(first_contact(PartMotion(Sphere{Vec3::Zero(), 1}, motion), kGround, {0, 1}, kWidth, bracket).yes());
  EXPECT_EQ(bracket.high, 0);
}

// Halving ends where no double lies between.
TEST(GroundMotion, TheNarrowestBracketIsOfTwoDoublesSideBySide) {
  const BodyMotion motion(at({0, 0, 4}), at({0, 0, 0.5}));
  TimeBracket bracket;
  const ExactResult verdict = first_contact(PartMotion(Sphere{Vec3::Zero(), 1}, motion), kGround, {0, 1}, 0, bracket);
  ASSERT_NE(verdict.decision, Decision::no);
  if (verdict.yes()) {
    EXPECT_NEAR(bracket.high, 3 / 3.5, 1e-14);
    EXPECT_NEAR(bracket.low, bracket.high, 1e-14);
  }
}

TEST(GroundMotion, OnlyWhatCannotComeDownSurelyStaysAbove) {
  const BodyMotion motion(at({0, 0, 4}), at({9, 0, 2}));
  EXPECT_TRUE(surely_stays_above(motion, 0.1, {.point = {0, 0, -5}, .normal = {0, 0, 1}}));
  EXPECT_FALSE(surely_stays_above(motion, 2.5, kGround));
  EXPECT_FALSE(surely_stays_above(motion, 0.1, {.point = {0, 0, 2.5}, .normal = {0, 0, 1}}));
}

}  // namespace
}  // namespace collided::engine::ground_motion_test
