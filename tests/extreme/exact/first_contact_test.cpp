#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::first_contact_test {
namespace {

using extreme::down;
using extreme::up;

void expect_time(const MovingSphere& mover, const auto& other, double truth) {
  TimeBracket bracket{-1, -1};
  ASSERT_TRUE(first_contact(mover, other, 0, bracket).yes());
  EXPECT_LE(bracket.low, truth);
  EXPECT_GE(bracket.high, truth);
  EXPECT_TRUE(bracket.low == bracket.high || up(bracket.low) == bracket.high) << bracket.low << " " << bracket.high;
}

void expect_never(const MovingSphere& mover, const auto& other) {
  TimeBracket bracket;
  EXPECT_EQ(first_contact(mover, other, 0, bracket).decision, Decision::no);
}

TEST(ExtremeFirstContact, ADoubleRootIsAHitAndOneStepBeyondIsNot) {
  const MovingSphere mover{{-10, 0, 0}, {10, 0, 0}, 1};
  expect_time(mover, Sphere{{0, 2, 0}, 1}, 0.5);
  expect_never(mover, Sphere{{0, up(2.0), 0}, 1});
  expect_time(mover, Capsule{{0, 2, -1}, {0, 2, 1}, 1}, 0.5);
  expect_never(mover, Capsule{{0, up(2.0), -1}, {0, up(2.0), 1}, 1});
}

// Where the ladder ends at double, a time that stays open may not move the bracket: it was taken for "not yet".
TEST(ExtremeFirstContact, ABracketThatMayNotClimbStillHoldsTheTruth) {
  const PrecisionScope doubles_only({.highest = Level::filter, .error_asked_m = 0});
  const MovingSphere mover{{-1, 0.1, 0.2}, {0.7, 0.1, 0.2}, 0.3};
  const double reach = 0.3 + 0.4;
  const double truth = (1 - std::sqrt(reach * reach - 0.1 * 0.1 - 0.2 * 0.2)) / 1.7;
  TimeBracket bracket{-1, -1};
  ASSERT_TRUE(first_contact(mover, Sphere{{0, 0, 0}, 0.4}, 0, bracket).yes());
  EXPECT_LE(bracket.low, truth + 1e-15);
  EXPECT_GE(bracket.high, truth - 1e-15);
  EXPECT_LT(bracket.high - bracket.low, 1e-9);
}

TEST(ExtremeFirstContact, BulletsDoNotTunnel) {
  const MovingSphere bullet{{-1e6, 0, 0}, {1e6, 0, 0}, 1};
  expect_time(bullet, Sphere{{0, 0, 0}, 1}, 0.499999);
  const Box wall{{0, 0, 0}, Mat3::Identity(), {0x1p-30, 100, 100}};
  expect_time({{-0x1p20, 0, 0}, {0x1p20, 0, 0}, 0}, wall, 0.5 - 0x1p-51);
  expect_time({{0, 0, 1e9}, {0, 0, -1e9}, 0}, Triangle{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, 0.5);
}

TEST(ExtremeFirstContact, StartEndAndNoMotion) {
  const Box box{{0, 0, 0}, Mat3::Identity(), {1, 1, 1}};
  TimeBracket bracket{-1, -1};
  EXPECT_TRUE(first_contact({{3, 0, 0}, {5, 0, 0}, 2}, box, 0, bracket).yes());
  EXPECT_EQ(bracket.high, 0);
  EXPECT_TRUE(first_contact({{3, 0, 0}, {3, 0, 0}, 2}, box, 0, bracket).yes());
  EXPECT_EQ(bracket.high, 0);
  expect_never({{3, 0, 0}, {3, 0, 0}, down(2.0)}, box);
  expect_time({{4, 0, 0}, {3, 0, 0}, 2}, box, 1);
  expect_never({{4, 0, 0}, {up(3.0), 0, 0}, 2}, box);
}

TEST(ExtremeFirstContact, ContactsAtTheVeryStartAreFoundQuickly) {
  const double gap = 0x1p-40;
  TimeBracket bracket;
  const MovingSphere fast{{2 + gap, 0, 0}, {-0x1p200, 0, 0}, 1};
  EXPECT_TRUE(first_contact(fast, Sphere{{0, 0, 0}, 1}, 0, bracket).yes());
  EXPECT_GT(bracket.high, 0);
  EXPECT_LE(bracket.low, gap / 0x1p200);
  EXPECT_GE(bracket.high, gap / 0x1p200 * (1 - 1e-9));
}

TEST(ExtremeFirstContact, ScaleDoesNotMatter) {
  for (int power = -400; power <= 400; power += 50) {
    const extreme::Scaling scale{power};
    const MovingSphere mover{scale(Vec3(-8, 0, 0)), scale(Vec3(8, 0, 0)), scale(1.0)};
    expect_time(mover, scale(Triangle{{-1, -4, -4}, {-1, 4, -4}, {-1, 0, 4}}), 0.375);
    expect_time(mover, scale(Box{{0, 0, 0}, Mat3::Identity(), {1, 1, 1}}), 0.375);
    expect_time(mover, scale(Capsule{{0, 0, -1}, {0, 0, 1}, 1}), 0.375);
  }
}

}  // namespace
}  // namespace collided::engine::first_contact_test
