#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/number.hpp"
#include "server/exact_phase/overlap/overlap.hpp"

namespace collided::engine::out_of_range_test {
namespace {

// Products of lengths near 2^990 are beyond what an expansion holds; the greater of such a number and another one must
// not pretend to be known.
TEST(ExtremeOutOfRange, TheGreaterOfALostNumberIsLost) {
  const Expansion lost = Expansion(0x1p900) * Expansion(0x1p900);
  ASSERT_TRUE(lost.lost());
  EXPECT_TRUE(kernel::max(lost, Expansion(1)).lost());
  EXPECT_TRUE(kernel::max(Expansion(1), lost).lost());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(max(Bounded(1, nan), Bounded(2)).error));
  EXPECT_TRUE(std::isnan(max(Bounded(2), Bounded(1, nan)).error));
}

TEST(ExtremeOutOfRange, ATriangleInAHugeBoxIsFound) {
  for (int power = 900; power <= 1015; power += 5) {
    const double unit = std::ldexp(1.0, power);
    const Box box{{0, 0, 0}, Mat3::Identity(), {4 * unit, 8 * unit, 16 * unit}};
    EXPECT_TRUE(overlaps(box, Triangle{{unit, 0, 0}, {0, unit, 0}, {0, 0, 3 * unit}}).yes()) << power;
    EXPECT_TRUE(overlaps(box, Triangle{{4 * unit, 0, 0}, {5 * unit, unit, 0}, {5 * unit, 0, unit}}).yes()) << power;
    EXPECT_EQ(overlaps(box, Triangle{{5 * unit, 0, 0}, {6 * unit, unit, 0}, {6 * unit, 0, unit}}).decision,
              Decision::no)
        << power;
  }
}

}  // namespace
}  // namespace collided::engine::out_of_range_test
