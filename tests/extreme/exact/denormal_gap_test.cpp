#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/part.hpp"

namespace collided::engine::denormal_gap_test {
namespace {

// A gap that vanishes in the first subtraction: beside coordinates of a half, 2^-1074 is lost at once, and the error of
// losing it underflows in the next product.

TEST(ExtremeDenormalGap, AStepBesideACornerIsAMiss) {
  const Triangle needle{{0, 0, 0}, {1, 0, 0}, {0.5, 0x1p-20, 0}};
  for (int power = -1074; power <= -900; power += 3) {
    const double x = -std::ldexp(1.0, power);
    const Triangle upright{{x, 0, -0.5}, {x, 0, 0.5}, {x, 0x1p-20, 0}};
    EXPECT_EQ(overlaps(needle, upright).decision, Decision::no) << power;
    EXPECT_EQ(overlaps(upright, needle).decision, Decision::no) << power;
  }
}

TEST(ExtremeDenormalGap, AStepBeforeTheWallIsNoContact) {
  const Box wall{.center = {1, 0, 0}, .half_m = {0.5, 1, 1}};
  for (int power = -1074; power <= -900; power += 3) {
    const MovingSphere mover{{-9, 0, 0}, {-std::ldexp(1.0, power), 0, 0}, 0.5};
    TimeBracket bracket;
    EXPECT_EQ(first_contact(mover, wall, 1e-12, bracket).decision, Decision::no) << power;
  }
  TimeBracket bracket;
  EXPECT_EQ(first_contact({{-9, 0, 0}, {0, 0, 0}, 0.5}, wall, 1e-12, bracket).decision, Decision::yes);
}

// Sizes and gaps of a few times the least double, whose halves and squares vanish.
TEST(ExtremeDenormalGap, ADistanceIsWithinItsBoundDownToTheLeastDouble) {
  for (int power = -1074; power <= -900; power += power < -1060 ? 1 : 7) {
    const double step = std::ldexp(1.0, power);
    for (const double size : {0.0, 1.0, 3.0}) {
      for (const double gap : {1.0, 2.0, 5.0}) {
        const Sphere ball{{-size * step, 0, 0}, size * step};
        const double far = gap * step;
        const ConvexPart others[] = {Primitive(Sphere{{far + size * step, 0, 0}, size * step}),
                                     Primitive(Box{.center = {far + step, 0, 0}, .half_m = {step, step, step}}),
                                     Primitive(Capsule{{far, -step, 0}, {far, step, 0}, 0}),
                                     Triangle{{far, -step, -step}, {far, step, -step}, {far, 0, step}}};
        for (const ConvexPart& other : others) {
          ASSERT_EQ(overlaps(ConvexPart(Primitive(ball)), other).decision, Decision::no)
              << power << " " << other.index();
          for (const Separation& told :
               {separation(ConvexPart(Primitive(ball)), other), separation(other, ConvexPart(Primitive(ball)))}) {
            // Both sides of the bound are exact: all are multiples of the least double.
            EXPECT_LE(std::abs(told.distance_m - far), told.error_m)
                << "2^" << power << ", size " << size << ", gap " << gap << ", other " << other.index();
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace collided::engine::denormal_gap_test
