// Stacks at rest stay at rest, on springs of any stiffness and under impulses.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/studies/response/event_driven.hpp"
#include "tests/studies/response/stepper.hpp"

namespace collided::response {
namespace {

constexpr std::size_t kSize = 10;
constexpr double kGravity = 9.81;

Line stack() { return {std::vector<double>(kSize, 1), std::vector<double>(kSize, 0.5), -kGravity, 0}; }

/// Each contact at the depth at which its spring bears what lies above.
Motion at_rest(double stiffness) {
  Motion motion{{}, std::vector<double>(kSize, 0)};
  double top_m = 0;
  for (std::size_t body = 0; body < kSize; ++body) {
    motion.position_m.push_back(top_m + 0.5 - kGravity * static_cast<double>(kSize - body) / stiffness);
    top_m = motion.position_m.back() + 0.5;
  }
  return motion;
}

double farthest(const Motion& one, const Motion& other) {
  double largest = 0;
  for (std::size_t body = 0; body < kSize; ++body)
    largest = std::max(largest, std::abs(one.position_m[body] - other.position_m[body]));
  return largest;
}

// Bullet's defaults: the same stack falls within 100 s.
TEST(ResponseResting, TenBodiesOnSpringsLieStillForAHundredThousandSteps) {
  for (const double stiffness : {1e4, 1e8, 1e12}) {
    Stepper stepper(stack(), {.spring = {.stiffness_n_m = stiffness, .damping_ratio = 0.1}});
    Motion motion = at_rest(stiffness);
    const Motion start = motion;
    for (int step = 0; step < 33'333; ++step) stepper.step(motion, 1e-3);
    EXPECT_LT(farthest(motion, start), 1e-13) << stiffness;
    EXPECT_EQ(stepper.episodes().began(), kSize) << stiffness;
    EXPECT_EQ(stepper.episodes().ended(), 0U) << stiffness;
    EXPECT_NEAR(stepper.counts().deepest_m, kGravity * kSize / stiffness, 1e-14) << stiffness;
  }
}

// k dt^2 / m = 1e6, and a gap's rounding moves its spring's force by 1e-4 of a weight: no reason to look closer.
TEST(ResponseResting, AStackOfTheStiffestSpringsCostsFewSubsteps) {
  Stepper stepper(stack(), {.spring = {.stiffness_n_m = 1e12, .damping_ratio = 0.2}});
  Motion motion = at_rest(1e12);
  for (int step = 0; step < 1000; ++step) stepper.step(motion, 1e-3);
  EXPECT_LT(stepper.counts().substeps + stepper.counts().repeated, 2'500U);
}

TEST(ResponseResting, AStackUnderImpulsesLiesStill) {
  for (const double restitution : {0.0, 0.5, 1.0}) {
    Stepper stepper(stack(), {.method = Method::impulse, .restitution = restitution});
    Motion motion = at_rest(1e300);
    const Motion start = motion;
    for (int step = 0; step < 100'000; ++step) stepper.step(motion, 1.0 / 60);
    EXPECT_LT(farthest(motion, start), 1e-13) << restitution;
    EXPECT_EQ(stepper.episodes().began(), kSize);
    EXPECT_EQ(stepper.episodes().ended(), 0U);
  }
}

// A stack dropped with gaps comes to rest at the depth that statics gives, whatever the path there.
TEST(ResponseResting, AFallenStackSettlesAtItsStaticDepths) {
  const double stiffness = 1e6;
  Stepper stepper(stack(), {.spring = {.stiffness_n_m = stiffness, .damping_ratio = damping_of_restitution(0.3)}});
  Motion motion = at_rest(stiffness);
  for (std::size_t body = 0; body < kSize; ++body) motion.position_m[body] += 0.01 * static_cast<double>(body + 1);
  for (int step = 0; step < 600; ++step) stepper.step(motion, 1.0 / 60);
  EXPECT_LT(farthest(motion, at_rest(stiffness)), 1e-9);
  EXPECT_EQ(stepper.counts().surrendered, 0U);
}

TEST(ResponseResting, RigidBodiesFallenOnEachOtherEndInRest) {
  const Line line = stack();
  Motion start = at_rest(1e300);
  for (std::size_t body = 0; body < kSize; ++body) start.position_m[body] += 0.01 * static_cast<double>(body + 1);
  EventDriven world(line, start, 0.3, 1e-6);
  world.advance(10);
  EXPECT_EQ(world.resting_count(), kSize);
  EXPECT_LT(farthest(world.motion(), at_rest(1e300)), 1e-12);
}

}  // namespace
}  // namespace collided::response
