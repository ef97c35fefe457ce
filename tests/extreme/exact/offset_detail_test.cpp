// Millimetres a hundred million metres out: squares of coordinates are 1e16, and single precision knows steps of 8 m.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::offset_detail_test {
namespace {

constexpr double kFar = 1e8;
constexpr double kMillimetre = 0x1p-10;  // about: the sums below are exact
constexpr double kStep = 0x1p-26;        // between doubles at kFar, 15 nanometres

Vec3 at(double x, double y, double z) { return {kFar + x, -kFar + y, kFar + z}; }

const Triangle kDetail{at(0, 0, 0), at(kMillimetre, 0, 0), at(0, kMillimetre, 0)};

TEST(ExtremeOffsetDetail, ARayOnTheEdgeHitsAndOneStepBesideMisses) {
  RayHit hit;
  const Vec3 down(0, 0, -1);
  ASSERT_TRUE(cast_ray({at(kMillimetre / 2, 0, 1), down}, kDetail, hit).yes());
  EXPECT_EQ(hit.distance_m, 1);
  EXPECT_FALSE(cast_ray({at(kMillimetre / 2, -kStep, 1), down}, kDetail, hit).yes());
  EXPECT_TRUE(cast_ray({at(kMillimetre / 2, kMillimetre / 2, 1), down}, kDetail, hit).yes());
  EXPECT_FALSE(cast_ray({at(kMillimetre / 2 + kStep, kMillimetre / 2, 1), down}, kDetail, hit).yes());
}

TEST(ExtremeOffsetDetail, BallsOfAMillimetreTouchToTheStep) {
  const Sphere ball{at(0, 0, 0), kMillimetre};
  EXPECT_TRUE(overlaps(ball, Sphere{at(2 * kMillimetre, 0, 0), kMillimetre}).yes());
  EXPECT_FALSE(overlaps(ball, Sphere{at(2 * kMillimetre + kStep, 0, 0), kMillimetre}).yes());
  EXPECT_TRUE(overlaps(ball, Box{.center = at(0, 1 + kMillimetre, 0), .half_m = {1, 1, 1}}).yes());
  EXPECT_FALSE(overlaps(ball, Box{.center = at(0, 1 + kMillimetre + kStep, 0), .half_m = {1, 1, 1}}).yes());
  EXPECT_TRUE(overlaps(Sphere{at(0, 0, kMillimetre), kMillimetre}, kDetail).yes());
  EXPECT_FALSE(overlaps(Sphere{at(0, 0, kMillimetre + kStep), kMillimetre}, kDetail).yes());
}

TEST(ExtremeOffsetDetail, DepthsAndDistancesAreTheDetailsOwn) {
  const Contact found = contact(Sphere{at(0, 0, 0), kMillimetre}, Sphere{at(kMillimetre, 0, 0), kMillimetre});
  EXPECT_EQ(found.depth_m, kMillimetre);
  const Closest near = closest(at(3 * kMillimetre, 4 * kMillimetre, 0), Sphere{at(0, 0, 0), kMillimetre});
  EXPECT_LE(std::abs(near.distance_m - 4 * kMillimetre), near.distance_error_m);
  EXPECT_LE(near.distance_error_m, 1e-12 * kMillimetre);
}

}  // namespace
}  // namespace collided::engine::offset_detail_test
