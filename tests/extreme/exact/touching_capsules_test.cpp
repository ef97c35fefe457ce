#include <gtest/gtest.h>

#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::touching_capsules_test {
namespace {

using extreme::down;
using extreme::up;

TEST(ExtremeTouchingCapsules, CrossedParallelAndEndOn) {
  const Capsule x_rod{{-5, 0, 0}, {5, 0, 0}, 1};
  for (const Capsule& other : {Capsule{{0, -5, 3}, {0, 5, 3}, 2}, Capsule{{-5, 0, 3}, {5, 0, 3}, 2},
                               Capsule{{8, 0, 0}, {12, 0, 0}, 2}, Capsule{{7, 2, 1}, {9, 9, 9}, 2}}) {
    EXPECT_TRUE(overlaps(x_rod, other).yes());
    Capsule thinner = other;
    thinner.radius_m = down(other.radius_m);
    EXPECT_FALSE(overlaps(x_rod, thinner).yes());
    EXPECT_FALSE(overlaps(thinner, x_rod).yes());
  }
}

// Nearly parallel axes: the common perpendicular is badly conditioned in double.
TEST(ExtremeTouchingCapsules, NearlyParallel) {
  for (int power = 0; power <= 300; power += 10) {
    const double tilt = std::ldexp(1.0, -power);
    const Capsule a{{-1, 0, 0}, {1, 0, 0}, 0.25};
    EXPECT_TRUE(overlaps(a, Capsule{{-1, -tilt, 0.5}, {1, tilt, 0.5}, 0.25}).yes()) << power;
    EXPECT_FALSE(overlaps(a, Capsule{{-1, -tilt, up(0.5)}, {1, tilt, up(0.5)}, 0.25}).yes()) << power;
  }
}

TEST(ExtremeTouchingCapsules, AgainstBoxAndTriangle) {
  const Box box{{0, 0, 0}, Mat3::Identity(), {1, 1, 1}};
  const Capsule over_edge{{-4, 4, 5}, {4, 4, 5}, 5};  // the edge y = z = 1 is 3-4-5 away
  EXPECT_TRUE(overlaps(box, over_edge).yes());
  EXPECT_FALSE(overlaps(box, Capsule{over_edge.a, over_edge.b, down(5.0)}).yes());
  const Capsule over_corner{{2, 3, 3}, {5, 5, 5}, 3};  // the corner (1, 1, 1) is 1-2-2 away
  EXPECT_TRUE(overlaps(box, over_corner).yes());
  EXPECT_FALSE(overlaps(box, Capsule{over_corner.a, over_corner.b, down(3.0)}).yes());
  const Triangle floor{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  EXPECT_TRUE(overlaps(Capsule{{1, 1, 2}, {1, 1, 9}, 2}, floor).yes());
  EXPECT_FALSE(overlaps(Capsule{{1, 1, up(2.0)}, {1, 1, 9}, 2}, floor).yes());
  EXPECT_TRUE(overlaps(Capsule{{1, 1, -2}, {1, 1, 9}, 0}, floor).yes()) << "a needle through it";
  EXPECT_TRUE(overlaps(Capsule{{-3, 1, 4}, {-3, 2, 4}, 5}, floor).yes());
  EXPECT_FALSE(overlaps(Capsule{{-3, 1, 4}, {-3, 2, 4}, down(5.0)}, floor).yes());
}

}  // namespace
}  // namespace collided::engine::touching_capsules_test
