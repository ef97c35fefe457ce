// U2: needles of aspect a million against each other and against balls: their normals are three digits of cancellation, and
// FCL is wrong about one needle pair in seven.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::needle_pairs_test {
namespace {

constexpr double kThin = 0x1p-20;

const Triangle kNeedle{{0, 0, 0}, {1, 0, 0}, {0.5, kThin, 0}};

/// A needle along z that crosses the plane z = 0 in the segment from (x, y) to (x, y + kThin).
Triangle upright(double x, double y) { return {{x, y, -0.5}, {x, y, 0.5}, {x, y + kThin, 0}}; }

TEST(ExtremeNeedlePairs, CrossedNeedlesAreDecidedToTheStep) {
  EXPECT_TRUE(overlaps(kNeedle, upright(0.5, 0)).yes());
  EXPECT_TRUE(overlaps(kNeedle, upright(0.5, kThin)).yes()) << "edge through apex";
  EXPECT_EQ(overlaps(kNeedle, upright(0.5, extreme::up(kThin))).decision, Decision::no);
  EXPECT_TRUE(overlaps(kNeedle, upright(0.5, -kThin)).yes()) << "apex on edge";
  EXPECT_EQ(overlaps(kNeedle, upright(0.5, -extreme::up(kThin))).decision, Decision::no);
  EXPECT_TRUE(overlaps(kNeedle, upright(0, 0)).yes()) << "edge through corner";
  EXPECT_EQ(overlaps(kNeedle, upright(-0x1p-1074, 0)).decision, Decision::no);
}

TEST(ExtremeNeedlePairs, BallsOverTheApexAndTheEdge) {
  EXPECT_TRUE(overlaps(Sphere{{0.5, 1 + kThin, 0}, 1}, kNeedle).yes());
  EXPECT_EQ(overlaps(Sphere{{0.5, extreme::up(1 + kThin), 0}, 1}, kNeedle).decision, Decision::no);
  EXPECT_TRUE(overlaps(Sphere{{0.25, -1, 0}, 1}, kNeedle).yes());
  EXPECT_EQ(overlaps(Sphere{{0.25, extreme::down(-1), 0}, 1}, kNeedle).decision, Decision::no);
  EXPECT_TRUE(overlaps(Sphere{{0.5, kThin / 2, 1}, 1}, kNeedle).yes());
  EXPECT_EQ(overlaps(Sphere{{0.5, kThin / 2, extreme::up(1)}, 1}, kNeedle).decision, Decision::no);
}

TEST(ExtremeNeedlePairs, DistancesKeepTwelveDigits) {
  for (double gap = 1; gap > 1e-12; gap /= 8) {
    const Closest above = closest({0.5, kThin / 2, gap}, kNeedle);
    EXPECT_LE(std::abs(above.distance_m - gap), above.distance_error_m);
    EXPECT_LE(above.distance_error_m, 1e-12 * gap);
    const Closest summand = closest({0.5, -gap, 0}, kNeedle);
    EXPECT_LE(std::abs(summand.distance_m - gap), summand.distance_error_m);
    EXPECT_LE(summand.distance_error_m, 1e-12 * gap);
  }
}

TEST(ExtremeNeedlePairs, BoxesFromTheSide) {
  EXPECT_TRUE(overlaps(Box{.center = {0.5, 1 + kThin, 0}, .half_m = {1, 1, 1}}, kNeedle).yes());
  EXPECT_EQ(overlaps(Box{.center = {0.5, extreme::up(1 + kThin), 0}, .half_m = {1, 1, 1}}, kNeedle).decision,
            Decision::no);
  EXPECT_EQ(overlaps(Box{.center = {0.25, 1 + kThin, 0}, .half_m = {0x1p-10, 1, 1}}, kNeedle).decision, Decision::no)
      << "the needle is lower there";
}

}  // namespace
}  // namespace collided::engine::needle_pairs_test
