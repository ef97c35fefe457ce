// Lengths of 1e200 and 1e-200 are doubles, their squares are infinity and zero: a distance by squares is then NaN, or
// everything touches.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::squares_overflow_test {
namespace {

constexpr int kPowers[] = {-1000, -665, -512, 512, 665, 1000};

TEST(ExtremeSquaresOverflow, BallsAtThreeFourFive) {
  for (const int power : kPowers) {
    const extreme::Scaling scale{power};
    const Sphere a = scale(Sphere{{0, 0, 0}, 3});
    EXPECT_TRUE(overlaps(a, scale(Sphere{{3, 4, 0}, 2})).yes()) << power;
    EXPECT_EQ(overlaps(a, scale(Sphere{{3, extreme::up(4), 0}, 2})).decision, Decision::no) << power;
    EXPECT_EQ(contact(a, scale(Sphere{{3, 4, 0}, 2})).depth_m, 0) << power;
    const Contact deeper = contact(a, scale(Sphere{{3, 4, 0}, 4}));
    EXPECT_EQ(deeper.depth_m, scale(2.0)) << power;
    EXPECT_NEAR(deeper.normal.x(), 0.6, 1e-15) << power;
  }
}

TEST(ExtremeSquaresOverflow, RaysAtBallsAndCapsules) {
  for (const int power : kPowers) {
    const extreme::Scaling scale{power};
    RayHit hit;
    ASSERT_TRUE(cast_ray(scale(Ray{{-9, 3, 0}, {1, 0, 0}}), scale(Sphere{{0, 0, 0}, 5}), hit).yes()) << power;
    EXPECT_EQ(hit.distance_m, scale(5.0));
    ASSERT_TRUE(cast_ray(scale(Ray{{-9, 3, 0}, {1, 0, 0}}), scale(Capsule{{0, 0, -1}, {0, 0, 1}, 5}), hit).yes())
        << power;
    EXPECT_EQ(hit.distance_m, scale(5.0));
    EXPECT_FALSE(cast_ray(scale(Ray{{-9, extreme::up(5), 0}, {1, 0, 0}}), scale(Sphere{{0, 0, 0}, 5}), hit).yes())
        << power;
  }
}

TEST(ExtremeSquaresOverflow, NearestDistances) {
  for (const int power : kPowers) {
    const extreme::Scaling scale{power};
    const Vec3 asked = scale(Vec3(3, 4, 0));
    EXPECT_EQ(closest(asked, scale(Sphere{{0, 0, 0}, 1})).distance_m, scale(4.0)) << power;
    EXPECT_EQ(closest(asked, scale(Capsule{{0, 0, -1}, {0, 0, 1}, 1})).distance_m, scale(4.0)) << power;
    EXPECT_EQ(closest(asked, scale(Triangle{{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}})).distance_m, scale(5.0)) << power;
    EXPECT_EQ(closest(scale(Vec3(4, 5, 0)), scale(Box{.center = {0, 0, 0}, .half_m = {1, 1, 1}})).distance_m,
              scale(5.0))
        << power;
  }
}

// The greatest double itself: differences overflow, not squares alone.
TEST(ExtremeSquaresOverflow, AcrossTheWholeRange) {
  constexpr double kGreatest = std::numeric_limits<double>::max();
  EXPECT_EQ(overlaps(Sphere{{-kGreatest, 0, 0}, 1}, Sphere{{kGreatest, 0, 0}, 1}).decision, Decision::no);
  EXPECT_TRUE(overlaps(Sphere{{-kGreatest, 0, 0}, kGreatest}, Sphere{{kGreatest, 0, 0}, kGreatest}).yes());
  EXPECT_EQ(overlaps(Sphere{{-kGreatest, 0, 0}, kGreatest}, Sphere{{kGreatest, 0x1p-1074, 0}, kGreatest}).decision,
            Decision::no);
  EXPECT_TRUE(
      overlaps(Box{.center = {0, 0, 0}, .half_m = Vec3::Constant(kGreatest)}, Sphere{{kGreatest, -kGreatest, 0}, 0})
          .yes());
  RayHit hit;
  ASSERT_TRUE(cast_ray({{-kGreatest, 0, 0}, {1, 0, 0}}, Box{.center = {0, 0, 0}, .half_m = {1, 1, 1}}, hit).yes());
  EXPECT_EQ(hit.distance_m, kGreatest);
}

}  // namespace
}  // namespace collided::engine::squares_overflow_test
