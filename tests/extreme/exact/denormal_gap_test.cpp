#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"

namespace collided::engine {
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

}  // namespace
}  // namespace collided::engine
