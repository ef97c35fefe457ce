#include <gtest/gtest.h>

#include <limits>

#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"

namespace collided::engine::not_finite_test {
namespace {

// The border refuses such input; should some get through, the answer is never "no" (a finite part of the shape may well
// touch), and nothing aborts.
TEST(ExtremeNotFinite, NothingIsDenied) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const Triangle t{{bad, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const Triangle good{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const Box box{{0, 0, 0}, Mat3::Identity(), {1, 1, 1}};
    RayHit hit;
    EXPECT_NE(cast_ray({{0.2, 0.2, 1}, {0, 0, -1}}, t, hit).decision, Decision::no);
    EXPECT_NE(cast_ray({{0.2, bad, 1}, {0, 0, -1}}, good, hit).decision, Decision::no);
    EXPECT_NE(cast_ray({{0.2, bad, 1}, {0, 0, -1}}, box, hit).decision, Decision::no);
    EXPECT_NE(cast_ray({{0.2, bad, 1}, {0, 0, -1}}, Sphere{{0, 0, 0}, 1}, hit).decision, Decision::no);
    EXPECT_NE(overlaps(t, good).decision, Decision::no);
    EXPECT_NE(overlaps(Sphere{{bad, 0, 0}, 1}, Sphere{{0, 0, 0}, 1}).decision, Decision::no);
    EXPECT_NE(overlaps(Sphere{{bad, 0, 0}, 1}, box).decision, Decision::no);
    EXPECT_NE(overlaps(box, t).decision, Decision::no);
    EXPECT_NE(overlaps(Capsule{{bad, 0, 0}, {1, 0, 0}, 1}, box).decision, Decision::no);
  }
}

// Finite input may overflow inside: it must not be taken for the case above.
TEST(ExtremeNotFinite, OverflowInsideIsDecidedAllTheSame) {
  const double huge = std::numeric_limits<double>::max();
  const Sphere a{{huge, huge, huge}, huge};
  EXPECT_TRUE(overlaps(a, Sphere{{huge, -huge, huge}, huge}).yes());
  EXPECT_FALSE(overlaps(a, Sphere{{huge, -huge, -huge}, huge}).yes());
  const Box world{{0, 0, 0}, Mat3::Identity(), Vec3::Constant(huge)};
  EXPECT_TRUE(overlaps(world, world).yes());
  EXPECT_TRUE(overlaps(a, world).yes());
  EXPECT_TRUE(
      overlaps(Triangle{{-huge, 0, 0}, {huge, 0, 0}, {0, huge, 0}}, Triangle{{0, 1, -huge}, {0, 1, huge}, {0, 2, huge}})
          .yes());
}

}  // namespace
}  // namespace collided::engine::not_finite_test
