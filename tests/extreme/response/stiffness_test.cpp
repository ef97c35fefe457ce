// k dt^2 / m from 1e-6 to 1e6 and beyond: what blows up, what loses, what holds.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/studies/response/reference.hpp"
#include "tests/studies/response/stepper.hpp"

namespace collided::response {
namespace {

Line ball() { return {{1}, {0}, 0, 0}; }

/// Growth of a small swing about rest in a spring that is loaded far deeper, so that it never lets go: the method's spectral radius
/// where it grows, after enough steps for the largest mode to have taken over.
double growth(Method method, double kappa) {
  const double load = 1;
  Line line{{1}, {0}, -load, 0};
  const double stiffness = kappa;  // with steps of a second
  Stepper stepper(line, {.method = method, .spring = {.stiffness_n_m = stiffness}});
  const double rest_m = -load / stiffness;
  const auto amplitude = [&](const Motion& motion) {
    return std::hypot(motion.position_m[0] - rest_m, motion.velocity_m_s[0]);
  };
  // From the slowest decade of growth that still fits between rounding and letting go.
  Motion motion{{rest_m * (1 + 1e-7)}, {0}};
  const int steps = kappa > 10 ? 2 : 100;
  for (int step = 0; step < steps; ++step) stepper.step(motion, 1);
  const double before = amplitude(motion);
  stepper.step(motion, 1);
  return amplitude(motion) / before;
}

// The limit itself: below 4 semi-implicit Euler swings on, above it the swing is multiplied on every step.
TEST(ResponseStiffness, SemiImplicitEulerBlowsUpFromFourOn) {
  EXPECT_NEAR(growth(Method::semi_implicit_euler, 4.01), 1.105124922, 1e-6);
  EXPECT_NEAR(growth(Method::semi_implicit_euler, 100), 97.9897948557, 1e-2);
  Stepper stepper({{1}, {0}, -1, 0}, {.method = Method::semi_implicit_euler, .spring = {.stiffness_n_m = 3.99}});
  Motion motion{{-1 / 3.99 * (1 + 1e-7)}, {0}};
  for (int step = 0; step < 100'000; ++step) {
    stepper.step(motion, 1);
    ASSERT_LT(std::abs(motion.position_m[0] + 1 / 3.99), 1e-5) << step;
  }
}

// Explicit Euler has no limit below which it holds: sqrt(1 + kappa) a step.
TEST(ResponseStiffness, ExplicitEulerGrowsAtAnyStiffness) {
  for (const double kappa : {1e-6, 1e-2, 1.0}) {
    Stepper stepper({{1}, {0}, -1, 0}, {.method = Method::explicit_euler, .spring = {.stiffness_n_m = kappa}});
    Motion motion{{-1 / kappa * (1 + 1e-7)}, {0}};
    const auto swing = [&] {
      return kappa * std::pow(motion.position_m[0] + 1 / kappa, 2) + std::pow(motion.velocity_m_s[0], 2);
    };
    const double before = swing();
    for (int step = 0; step < 10; ++step) stepper.step(motion, 1);
    EXPECT_NEAR(swing() / before, std::pow(1 + kappa, 10), 1e-6 * std::pow(1 + kappa, 10)) << kappa;
  }
}

TEST(ResponseStiffness, ImplicitEulerDampsAsItsTheorySays) {
  Stepper stepper({{1}, {0}, -1, 0}, {.method = Method::implicit_euler, .spring = {.stiffness_n_m = 100}});
  Motion motion{{-0.01 * (1 + 1e-3)}, {0}};
  const auto swing = [&] {
    return 100 * std::pow(motion.position_m[0] + 0.01, 2) + std::pow(motion.velocity_m_s[0], 2);
  };
  const double before = swing();
  stepper.step(motion, 1);
  EXPECT_NEAR(std::sqrt(swing() / before), 0.0995037190, 1e-9);
}

TEST(ResponseStiffness, ImplicitEulerNeverGainsEnergy) {
  for (double stiffness = 1e2; stiffness < 2e12; stiffness *= 10) {
    const Line line{{1, 1e6, 1}, {0.1, 0.1, 0.1}, -9.81, 0, 2};
    Stepper stepper(line, {.method = Method::implicit_euler, .spring = {.stiffness_n_m = stiffness}});
    Motion motion{{0.2, 0.5, 1.5}, {3, -2, 20}};
    double energy = stepper.energy(motion);
    for (int step = 0; step < 1000; ++step) {
      stepper.step(motion, 0.01);
      const double now = stepper.energy(motion);
      ASSERT_LE(now, energy + 1e-9 * std::abs(energy)) << stiffness << ' ' << step;
      energy = now;
    }
  }
}

// From k dt^2 / m = 1e-6 to 1e8: the contact may last a thousand steps or a ten-thousandth of one.
TEST(ResponseStiffness, EveryBounceReturnsItsSpeed) {
  for (double stiffness = 1e2; stiffness < 2e12; stiffness *= 10) {
    for (const double restitution : {1.0, 0.5, 0.1}) {
      for (const double step_s : {1e-4, 1e-2}) {
        Stepper stepper(ball(),
                        {.spring = {.stiffness_n_m = stiffness, .damping_ratio = damping_of_restitution(restitution)}});
        Motion motion{{0.0123}, {-1}};
        const int steps = static_cast<int>(1 / step_s);
        for (int step = 0; step < steps; ++step) stepper.step(motion, step_s);
        EXPECT_NEAR(motion.velocity_m_s[0], restitution, 1e-6) << stiffness << ' ' << step_s;
        EXPECT_EQ(stepper.episodes().began(), 1U);
        EXPECT_EQ(stepper.episodes().ended(), 1U);
      }
    }
  }
}

TEST(ResponseStiffness, PenetrationIsWhatStaticsAndEnergySay) {
  for (const double stiffness : {1e2, 1e6, 1e8, 1e12}) {
    Stepper bounce(ball(), {.spring = {.stiffness_n_m = stiffness}});
    Motion motion{{0.01}, {-2}};
    for (int step = 0; step < 100; ++step) bounce.step(motion, 0.01);
    EXPECT_NEAR(bounce.counts().deepest_m, 2 / std::sqrt(stiffness), 1e-4 * 2 / std::sqrt(stiffness)) << stiffness;
    Stepper rest({{1}, {0}, -9.81, 0}, {.spring = {.stiffness_n_m = stiffness, .damping_ratio = 0.5}});
    Motion laid{{0}, {0}};
    for (int step = 0; step < 1'000; ++step) rest.step(laid, 0.01);
    EXPECT_NEAR(-laid.position_m[0], 9.81 / stiffness, 1e-9 * 9.81 / stiffness) << stiffness;
  }
}

// At 1e6 m a gap is known to 1e-10 m, a hundred times what a weight presses the stiffest spring in by.
TEST(ResponseStiffness, FarFromTheOriginTheControllerStillEnds) {
  Stepper stepper({{1}, {1}, -9.81, 1e6}, {.spring = {.stiffness_n_m = 1e12, .damping_ratio = 0.2}});
  Motion motion{{1e6 + 1.5}, {-1}};
  for (int step = 0; step < 500; ++step) stepper.step(motion, 0.01);
  EXPECT_NEAR(motion.position_m[0], 1e6 + 1, 1e-8);
  EXPECT_LT(stepper.counts().substeps, 1'000'000U);
}

// Ninety thousand bounces in one step are more than it resolves: it ends, says that it gave up, and has gained nothing.
TEST(ResponseStiffness, AStepOfADayEnds) {
  Stepper stepper({{1}, {0}, -9.81, 0}, {.spring = {.stiffness_n_m = 1e8}});
  Motion motion{{1}, {0}};
  stepper.step(motion, 86'400);
  EXPECT_EQ(stepper.counts().surrendered, 1U);
  EXPECT_TRUE(std::isfinite(motion.position_m[0]));
  EXPECT_LE(stepper.energy(motion), 9.82);
}

// What overflows comes out not finite, but it comes out.
TEST(ResponseStiffness, AnOverflowEnds) {
  for (const double speed : {1e150, 1e300, 1.7e308}) {
    Stepper stepper({{1, 1}, {1, 1}, -9.81, 0}, {.spring = {.stiffness_n_m = 1e12, .damping_ratio = 0.1}});
    Motion motion{{0.999, 2.9}, {-speed, speed}};
    stepper.step(motion, 0.01);
    EXPECT_LT(stepper.counts().substeps, 300'000U) << speed;
    EXPECT_LT(stepper.counts().repeated, 300'000U) << speed;
  }
}

}  // namespace
}  // namespace collided::response
