#include <gtest/gtest.h>

#include <cfenv>
#include <limits>

#include "server/geometry/float_environment.hpp"

namespace collided {
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

}  // namespace
}  // namespace collided
