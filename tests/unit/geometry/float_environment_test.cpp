#include <gtest/gtest.h>

#include <cfenv>
#include <limits>

#include "server/geometry/float_environment.hpp"

namespace collided::engine {
namespace {

TEST(FloatEnvironment, AnotherRoundingIsSetBackOnce) {
  ASSERT_FALSE(restore_float_environment());
  std::fesetround(FE_UPWARD);
  EXPECT_TRUE(restore_float_environment());
  volatile double one = 1;
  EXPECT_EQ(one + std::numeric_limits<double>::min(), 1);
  EXPECT_FALSE(restore_float_environment());
  std::fesetround(FE_TONEAREST);
}

TEST(FloatEnvironment, FlagsOfPastOperationsAreNoSetting) {
  std::feraiseexcept(FE_INEXACT | FE_UNDERFLOW);
  EXPECT_FALSE(restore_float_environment());
}

TEST(FloatEnvironment, TheHostGetsItsOwnBack) {
  std::fesetround(FE_UPWARD);
  std::feclearexcept(FE_ALL_EXCEPT);
  {
    const OwnFloatEnvironment own;
    volatile double one = 1;
    EXPECT_EQ(one + std::numeric_limits<double>::min(), 1);
    std::feraiseexcept(FE_INVALID);
  }
  EXPECT_EQ(std::fegetround(), FE_UPWARD);
  EXPECT_EQ(std::fetestexcept(FE_INVALID), 0);
  std::fesetround(FE_TONEAREST);
}

}  // namespace
}  // namespace collided::engine
