// A step of no length, or of next to none, changes nothing or next to nothing.
#include <cmath>

#include <gtest/gtest.h>

#include "client/cli/publish/response/spheres.hpp"
#include "tests/studies/response/event_driven.hpp"
#include "tests/studies/response/stepper.hpp"

namespace collided::response {
namespace {

constexpr Method kMethods[]{Method::explicit_euler, Method::semi_implicit_euler, Method::implicit_euler,
                            Method::compliant, Method::impulse};

TEST(ResponseZeroStep, ChangesNotABit) {
  const Line line{{1, 2}, {0.5, 0.5}, -9.81, 0};
  for (const Method method : kMethods) {
    Stepper stepper(line, {.method = method, .spring = {.stiffness_n_m = 1e12}});
    Motion motion{{0.4999, 1.4}, {-1, -2}};
    for (int step = 0; step < 10; ++step) stepper.step(motion, 0);
    EXPECT_EQ(motion.position_m, std::vector<double>({0.4999, 1.4})) << name(method);
    EXPECT_EQ(motion.velocity_m_s, std::vector<double>({-1, -2})) << name(method);
  }
  EventDriven world(line, {{1, 3}, {0, 0}}, 1);
  world.advance(0);
  EXPECT_EQ(world.motion().position_m, std::vector<double>({1, 3}));
}

TEST(ResponseZeroStep, TheSmallestNumberIsAStepToo) {
  const Line line{{1, 2}, {0.5, 0.5}, -9.81, 0};
  for (const Method method : kMethods) {
    for (const double seconds : {5e-324, 1e-300, 1e-30}) {
      Stepper stepper(line, {.method = method, .spring = {.stiffness_n_m = 1e12, .damping_ratio = 0.1}});
      Motion motion{{0.49999, 1.4}, {-1, -2}};
      stepper.step(motion, seconds);
      EXPECT_EQ(motion.position_m, std::vector<double>({0.49999, 1.4})) << name(method) << seconds;
      // An impulse has no length; the others have done next to no work.
      if (method != Method::impulse) { EXPECT_NEAR(motion.velocity_m_s[1], -2, 1e-15) << name(method) << seconds; }
    }
  }
}

// Half a step of no length beside a whole one: 1e5 steps of zero between two frames are not one contact more.
TEST(ResponseZeroStep, NoContactComesOfIt) {
  Stepper stepper({{1}, {0}, -9.81, 0}, {.spring = {.stiffness_n_m = 1e9}});
  Motion motion{{1}, {0}};
  for (int step = 0; step < 100; ++step) {
    stepper.step(motion, 0.02);
    for (int empty = 0; empty < 1'000; ++empty) stepper.step(motion, 0);
  }
  EXPECT_EQ(stepper.episodes().began(), 2U);
}

}  // namespace
}  // namespace collided::response
