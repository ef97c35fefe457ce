// A contact that begins and ends inside one step leaves as it should, and is counted.
#include <cmath>

#include <gtest/gtest.h>

#include "client/cli/publish/response/damper.hpp"
#include "tests/studies/response/reference.hpp"
#include "tests/studies/response/stepper.hpp"

namespace collided::response {
namespace {

TEST(ResponseOnset, AContactInsideOneStepIsSeenAndAnswered) {
  for (const double stiffness : {1e6, 1e9, 1e12}) {
    Stepper stepper({{1}, {0}, 0, 0}, {.spring = {.stiffness_n_m = stiffness}});
    Motion motion{{0.5}, {-1}};
    stepper.step(motion, 1);
    const double contact_s = 3.14159265358979 / std::sqrt(stiffness);
    EXPECT_NEAR(motion.velocity_m_s[0], 1, 1e-6);
    EXPECT_NEAR(motion.position_m[0], 0.5 - contact_s, 1e-6);
    EXPECT_EQ(stepper.episodes().began(), 1U);
    EXPECT_EQ(stepper.episodes().ended(), 1U);
  }
}

// Between two walls at 1 km/s a hundred bounces in one step, none missed.
TEST(ResponseOnset, AHundredContactsInsideOneStep) {
  Stepper stepper({{1}, {0}, 0, 0, 1}, {.spring = {.stiffness_n_m = 1e12}});
  Motion motion{{0.5}, {1000}};
  const double period = 1 / 1000.0 + 3.14159265358979e-6;
  stepper.step(motion, 100 * period);
  EXPECT_EQ(stepper.episodes().began(), 100U);
  EXPECT_NEAR(motion.position_m[0], 0.5, 1e-3);
  EXPECT_NEAR(motion.velocity_m_s[0], 1000, 1e-2);
}

TEST(ResponseOnset, ADampedContactFeelsItsDamperFromTheFirstInstant) {
  const Spring spring{.stiffness_n_m = 1e8, .damping_ratio = 0.4};
  for (const double start_m : {0.1, 0.3, 0.7, 1.1}) {
    Stepper stepper({{1}, {0}, 0, 0}, {.spring = spring});
    Motion motion{{start_m}, {-1}};
    stepper.step(motion, 2);
    EXPECT_NEAR(motion.velocity_m_s[0], restitution_of_damping(0.4), 1e-6) << start_m;
    EXPECT_LT(stepper.counts().substeps, 3'000U) << start_m;
  }
}

// However a flight is cut into steps, the bounce is the same.
TEST(ResponseOnset, TheCutIntoStepsDoesNotMatter) {
  const Spring spring{.stiffness_n_m = 1e7};
  const ReferenceState reference = compliant_ball(spring, 1, 9.81, 1, 0, 2);
  for (const int steps : {1, 3, 10, 97, 1'000, 12'345}) {
    Stepper stepper({{1}, {0}, -9.81, 0}, {.spring = spring});
    Motion motion{{1}, {0}};
    for (int step = 0; step < steps; ++step) stepper.step(motion, 2.0 / steps);
    EXPECT_NEAR(motion.position_m[0], reference.position_m, 1e-6) << steps;
    EXPECT_EQ(stepper.episodes().began(), reference.contacts) << steps;
  }
}

}  // namespace
}  // namespace collided::response
