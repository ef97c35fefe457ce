#include <cmath>

#include <gtest/gtest.h>

#include "client/cli/publish/response/damper.hpp"

namespace collided::response {
namespace {

TEST(ResponseDamper, ItsRestitutionIsThatOfTheContactItself) {
  for (const double ratio : {0.0, 0.01, 0.2, 0.5, 0.70710678118654752, 0.9, 1.0, 1.5, 5.0}) {
    const ContactPhase phase({.stiffness_n_m = 1e4, .damping_ratio = ratio}, 2.0, 3.0, 0);
    const double leaves = -phase.depth_rate(phase.duration());
    EXPECT_NEAR(leaves / 3.0, restitution_of_damping(ratio), 1e-9) << ratio;
  }
}

TEST(ResponseDamper, RestitutionAndDampingAreInverse) {
  for (const double restitution : {1e-3, 0.01, 0.1, 0.25, 0.5, 0.9, 0.999, 1.0}) {
    EXPECT_NEAR(restitution_of_damping(damping_of_restitution(restitution)), restitution, 2e-15) << restitution;
  }
  EXPECT_EQ(damping_of_restitution(1), 0);
}

TEST(ResponseDamper, ARestitutionThatNoDamperGivesIsRefused) {
  EXPECT_THROW((void)damping_of_restitution(9e-4), std::invalid_argument);
  EXPECT_THROW((void)damping_of_restitution(1.0001), std::invalid_argument);
  EXPECT_THROW((void)damping_of_restitution(std::nan("")), std::invalid_argument);
}

// The closed form satisfies its own equation m y" + d y' + k y = load, by differences, damped and not, loaded and not.
TEST(ResponseContactPhase, SolvesItsEquation) {
  for (const double ratio : {0.0, 0.3, 2.0}) {
    for (const double load : {0.0, 20.0}) {
      const Spring spring{.stiffness_n_m = 100, .damping_ratio = ratio};
      const ContactPhase phase(spring, 1, 2, load);
      EXPECT_NEAR(phase.depth(0), 0, 1e-15);
      EXPECT_NEAR(phase.depth_rate(0), 2, 1e-14);
      for (double t = 0.01; t < 0.3; t += 0.01) {
        const double h = 1e-6;  // differences of it are within h^2 times the third derivative, 1e-9 and 1e-7
        const double acceleration = (phase.depth_rate(t + h) - phase.depth_rate(t - h)) / (2 * h);
        EXPECT_NEAR((phase.depth(t + h) - phase.depth(t - h)) / (2 * h), phase.depth_rate(t), 1e-9);
        EXPECT_NEAR(acceleration + spring.damping(1) * phase.depth_rate(t) + 100 * phase.depth(t), load, 1e-7);
      }
    }
  }
}

TEST(ResponseContactPhase, AnUndampedContactLastsHalfAPeriodAndReturnsItsSpeed) {
  const ContactPhase phase({.stiffness_n_m = 1e12}, 1, 4, 0);
  EXPECT_NEAR(phase.duration(), 3.141592653589793e-6, 1e-20);
  EXPECT_NEAR(phase.depth_rate(phase.duration()), -4, 1e-14);
  EXPECT_NEAR(phase.deepest(), 4e-6, 1e-20);
}

TEST(ResponseContactPhase, AWeightWithoutSpeedStaysForEver) {
  const ContactPhase phase({.stiffness_n_m = 1e8, .damping_ratio = 0.2}, 1, 0, 9.81);
  EXPECT_TRUE(std::isinf(phase.duration()));
  EXPECT_NEAR(phase.depth(1), 9.81e-8, 1e-20);
}

}  // namespace
}  // namespace collided::response
