#include <gtest/gtest.h>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::touching_spheres_test {
namespace {

using extreme::down;
using extreme::up;

// Differences whose length is an integer: 1-2-2, 2-3-6, 3-4-5 (in a plane), 4-4-7, 1-4-8.
const std::pair<Vec3, double> kQuadruples[] = {{{1, 2, 2}, 3}, {{2, 3, 6}, 7}, {{3, 4, 0}, 5},
                                               {{4, 4, 7}, 9}, {{1, 4, 8}, 9}, {{2, 10, 11}, 15}};

// A39: touching overlaps, and squares are compared without rounding.
TEST(ExtremeTouchingSpheres, OneStepPartsThem) {
  for (const auto& [step, length] : kQuadruples) {
    for (int power = -900; power <= 900; power += 100) {
      const extreme::Scaling scale{power};
      const double half = scale(length / 2);
      const Sphere a = scale(Sphere{{0, 0, 0}, length / 2});
      const Vec3 b = scale(step);
      EXPECT_TRUE(overlaps(a, Sphere{b, half}).yes());
      EXPECT_FALSE(overlaps(a, Sphere{b, down(half)}).yes());
      EXPECT_TRUE(overlaps(a, Sphere{b, up(half)}).yes());
      EXPECT_EQ(contact(a, Sphere{b, half}).depth_m, 0);
      EXPECT_GT(contact(a, Sphere{b, up(half)}).depth_m, 0);
    }
  }
}

// The sum of the radii needs more digits than a double has.
TEST(ExtremeTouchingSpheres, TheSumOfRadiiIsNotRounded) {
  const Sphere a{{0, 0, 0}, 1};
  const double tiny = 0x1p-80;
  EXPECT_FALSE(overlaps(a, Sphere{{up(1.0), 0, 0}, tiny}).yes());
  EXPECT_TRUE(overlaps(a, Sphere{{1, tiny, 0}, tiny}).yes());
  EXPECT_TRUE(overlaps(a, Sphere{{1, 0, 0x1p-41}, 0x1p-82}).yes());
  EXPECT_FALSE(overlaps(a, Sphere{{1, 0, 0x1p-40}, 0x1p-82}).yes());
}

TEST(ExtremeTouchingSpheres, PointsTouchOnlyThemselves) {
  const Sphere point{{1e6, 0.1, -3}, 0};
  EXPECT_TRUE(overlaps(point, point).yes());
  EXPECT_FALSE(overlaps(point, Sphere{{1e6, up(0.1), -3}, 0}).yes());
}

}  // namespace
}  // namespace collided::engine::touching_spheres_test
